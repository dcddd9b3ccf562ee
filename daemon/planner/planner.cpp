#include "daemon/planner/planner.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "daemon/planner/anchor.h"
#include "daemon/planner/budget_choice.h"
#include "daemon/planner/direction_index.h"
#include "daemon/planner/estimate.h"
#include "daemon/planner/exposure_ladder.h"
#include "daemon/planner/measuring_order.h"
#include "daemon/planner/part_directions.h"
#include "drivers/motion/route.h"

namespace gonio::daemon {

namespace {

constexpr std::int64_t kMostPoints = 10'000'000;  // more is a slip of a plan's author, and would fill the disk

// Where the plan, or a list of points, asked for a direction.
struct Origin {
  InputLocation where;
  bool is_listed = false;
};

class Expansion {
 public:
  Expansion(const api::Plan& plan, const Instrument& instrument, const TimeExperience& experience)
      : plan_(plan),
        instrument_(instrument),
        experience_(experience),
        is_relative_(plan.relative_azimuth.value_or(plan.isotropic)),
        known_(plan.isotropic) {}

  Result<PlannedScan> run() {
    if (!plan_.theta_r.empty()) GONIO_TRY(take(product_of(plan_)));
    for (const api::PlanPart& part : plan_.parts) {
      ++part_;
      GONIO_TRY(take(part));
    }
    if (plan_.is_reciprocal) GONIO_TRY(add_partners());
    if (plan_.reference_mode == api::ReferenceMode::Anchor) GONIO_TRY(add_anchors());
    GONIO_TRY(check_count());
    if (plan_.budget && !are_all_blocked()) return within_budget();
    repeat(repeats_);
    return finish(plan_);
  }

 private:
  static api::PlanPart product_of(const api::Plan& plan) {
    return {.where = {.field = "geometry"},
            .theta_i = plan.theta_i,
            .phi_i = plan.phi_i,
            .wavelengths = plan.wavelengths,
            .repeats = plan.repeats,
            .shape = api::ProductShape{plan.theta_r, plan.phi_r}};
  }

  [[nodiscard]] Result<void> check_count() const {
    if (planned_.asked > 0 && planned_.asked <= kMostPoints) return {};
    return failure(Error{.code = ErrorCode::InvalidInput,
                         .device = "plan",
                         .tried = "expand [geometry]",
                         .seen = planned_.asked == 0 ? "no points" : fmt::format("{} points or more", planned_.asked),
                         .limit = fmt::format("1 to {} points", kMostPoints),
                         .where = InputLocation{.field = "geometry"}});
  }

  // Before lists that are too long are walked.
  [[nodiscard]] static double combinations(const api::PlanPart& part) {
    const auto* product = std::get_if<api::ProductShape>(&part.shape);
    if (product == nullptr) return 0.0;
    double all = part.repeats;
    for (const std::size_t n : {part.theta_i.size(), part.phi_i.size(), product->theta_r.size(), product->phi_r.size(),
                                part.wavelengths.size()}) {
      all *= static_cast<double>(n);
    }
    return all;
  }

  Result<void> take(const api::PlanPart& part) {
    if (combinations(part) > static_cast<double>(kMostPoints)) {
      planned_.asked = kMostPoints + 1;
      return check_count();
    }
    return for_each_direction(part, instrument_, is_relative_, [&](const AskedDirection& asked) -> Result<void> {
      Origin origin{part.where};
      if (const auto* list = std::get_if<api::ListShape>(&part.shape)) origin = {{list->file, asked.line, ""}, true};
      if (asked.wavelength) return take(asked, *asked.wavelength, part.repeats, origin);
      for (const Wavelength wavelength : part.wavelengths) {
        GONIO_TRY(take(asked, wavelength, part.repeats, origin));
      }
      return {};
    });
  }

  Result<void> take(const AskedDirection& asked, Wavelength wavelength, int repeats, const Origin& origin) {
    planned_.asked += repeats;
    if (planned_.asked > kMostPoints) return check_count();
    const auto point = reached(asked.geometry, wavelength, origin);
    wanted_by_now_ = {part_, asked.level < 0 ? ++last_unit_ : unit_of_level(asked.level), asked.level};
    if (!point && asked.may_be_out_of_reach && point.error().code == ErrorCode::OutOfLimits) {
      planned_.out_of_reach += repeats;
      return {};
    }
    if (!point) return failure(point.error());
    add(*point, repeats);
    return {};
  }

  [[nodiscard]] static Error nothing_open() {
    return {.code = ErrorCode::InvalidInput,
            .tried = "look into the source past the targets",
            .seen = "no place of the carriage where nothing stands in the beam",
            .limit = "[stage.carriage] open_mm in instrument.toml"};
  }

  void add(const ScanPoint& point, int repeats) {
    const auto number = static_cast<std::int32_t>(planned_.points.size());
    const auto twin = known_.find_or_add(point.geometry, point.wavelength, number);
    if (!twin) {
      planned_.points.push_back(point);
      repeats_.push_back(repeats);
      wanted_by_.push_back(wanted_by_now_);
      return;
    }
    int& kept = repeats_[static_cast<std::size_t>(*twin)];
    planned_.merged += std::min(kept, repeats);
    kept = std::max(kept, repeats);
  }

  [[nodiscard]] Result<ScanPoint> reached(const Geometry& g, Wavelength wavelength, const Origin& origin) const {
    ScanPoint point{.geometry = g, .wavelength = wavelength};
    const auto target = axis_targets(g, wavelength, instrument_, home_);
    if (!target) return failure(named_by_the_plan(target.error(), g, origin));
    if (is_below_surface(g) && !instrument_.carriage.open) return failure(named_by_the_plan(nothing_open(), g, origin));
    // An axis that turns past its target must be able to, wherever it comes from.
    const auto turns = drivers::check_approach(instrument_.stage, *target);
    if (!turns) return failure(named_by_the_plan(turns.error(), g, origin));
    point.blocked = is_blocked(g, instrument_);
    return point;
  }

  // Source and detector exchanged. With an isotropic sample both turn together until phi_i is what it was.
  [[nodiscard]] Geometry exchanged(const Geometry& g) const {
    if (!plan_.isotropic) return {.theta_i = g.theta_r, .phi_i = g.phi_r, .theta_r = g.theta_i, .phi_r = g.phi_i};
    return {.theta_i = g.theta_r, .phi_i = g.phi_i, .theta_r = g.theta_i, .phi_r = g.phi_i - (g.phi_r - g.phi_i)};
  }

  Result<void> add_partners() {
    const std::size_t asked = planned_.points.size();
    for (std::size_t k = 0; k < asked; ++k) {
      const ScanPoint point = planned_.points[k];
      const Geometry g = exchanged(point.geometry);
      if (known_.find(g, point.wavelength)) continue;
      const auto partner = reached(g, point.wavelength, {});
      if (!partner && partner.error().code != ErrorCode::OutOfLimits) return failure(partner.error());
      if (!partner) {
        planned_.without_partner.push_back(static_cast<std::int32_t>(k));
        continue;
      }
      planned_.asked += repeats_[k];
      wanted_by_now_ = wanted_by_[k];
      add(*partner, repeats_[k]);
    }
    return {};
  }

  // Levels of one part are units of their own, whatever the light.
  int unit_of_level(int level) {
    const auto [unit, is_new] = level_units_.try_emplace({part_, level}, last_unit_ + 1);
    if (is_new) ++last_unit_;
    return unit->second;
  }

  [[nodiscard]] bool are_all_blocked() const { return std::ranges::all_of(planned_.points, &ScanPoint::blocked); }

  // The standard is visited at a point of the scan, so that its way and its limits are those of points: the sample is
  // measured there too.
  Result<void> add_anchors() {
    if (plan_.budget) return failure(budget_with_anchor());
    const std::vector<ScanPoint> asked = planned_.points;
    std::vector<Wavelength> done;
    for (const ScanPoint& point : asked) {
      if (std::find(done.begin(), done.end(), point.wavelength) != done.end()) continue;
      done.push_back(point.wavelength);
      const bool is_there = std::any_of(asked.begin(), asked.end(), [&](const ScanPoint& other) {
        return other.wavelength == point.wavelength && is_at_anchor(other.geometry, plan_.anchor);
      });
      const auto anchor = reached(plan_.anchor, point.wavelength, {{.field = "reference.anchor"}});
      if (!anchor) return failure(anchor.error());
      if (anchor->blocked) return failure(blocked_anchor());
      if (is_there) continue;
      add(*anchor, 1);
      ++planned_.anchors;
    }
    return {};
  }

  // The share of a budget knows no point that must be kept.
  [[nodiscard]] static Error budget_with_anchor() {
    return {.code = ErrorCode::InvalidInput,
            .device = "plan",
            .tried = "leave points out for the budget",
            .seen = "the standard is visited at one of them",
            .limit = "a budget in same-geometry or absolute mode, or no budget",
            .where = InputLocation{.field = "reference.mode"}};
  }

  [[nodiscard]] Error blocked_anchor() const {
    return {.code = ErrorCode::Blocked,
            .device = "plan",
            .tried = fmt::format("read the standard at the anchor {:g}/{:g} deg", in_degrees(plan_.anchor.theta_i),
                                 in_degrees(plan_.anchor.theta_r)),
            .seen = "it lies in the shadow of the detector's head, or the arms would meet",
            .limit = "a geometry outside of the keep-out about retro-reflection",
            .where = InputLocation{.field = "reference.anchor"}};
  }

  // Each point as often as it is measured, under an index of its own.
  void repeat(const std::vector<int>& repeats) {
    std::vector<ScanPoint> once = std::exchange(planned_.points, {});
    std::vector<std::int32_t> first(once.size(), -1);
    for (std::size_t k = 0; k < once.size(); ++k) {
      if (repeats[k] > 0) first[k] = static_cast<std::int32_t>(planned_.points.size());
      for (int n = 1; n <= repeats[k]; ++n) {
        once[k].index = static_cast<std::int32_t>(planned_.points.size());
        once[k].repeat = n;
        planned_.points.push_back(once[k]);
      }
    }
    for (std::int32_t& alone : planned_.without_partner) alone = first[static_cast<std::size_t>(alone)];
    std::erase(planned_.without_partner, -1);
  }

  Result<PlannedScan> within_budget() {
    std::vector<BudgetCandidate> candidates;
    for (std::size_t k = 0; k < planned_.points.size(); ++k) {
      const WantedBy& by = wanted_by_[k];
      candidates.push_back({planned_.points[k], repeats_[k], by.part, by.unit, by.level});
    }
    auto share = share_out(plan_, instrument_, experience_, candidates);
    if (!share) return failure(share.error());
    planned_.budget = share->choice;
    repeat(share->repeats);
    api::Plan chosen = plan_;
    chosen.target_snr = share->choice.target_snr;
    return finish(chosen);
  }

  // The instrument's error, with what the plan calls it and where it asked; where no axis is one of the plan's angles,
  // with the direction.
  [[nodiscard]] Error named_by_the_plan(Error error, const Geometry& g, const Origin& origin) const {
    std::string field = "wavelength_nm";
    const bool is_direction = error.code == ErrorCode::OutOfLimits;
    if (is_direction && instrument_.stage.kinematics.kind != drivers::KinematicsKind::Arms) {
      field.clear();
      error.tried +=
          fmt::format(" for theta_i {:.3f}, phi_i {:.3f}, theta_r {:.3f}, phi_r {:.3f} deg", in_degrees(g.theta_i),
                      in_degrees(g.phi_i), in_degrees(g.theta_r), in_degrees(g.phi_r));
    } else if (is_direction) {
      field.clear();
      for (const auto axis : {stage::Axis::ThetaI, stage::Axis::ThetaR, stage::Axis::PhiR, stage::Axis::PhiI}) {
        const std::string name(stage::axis_name(axis));
        if (error.tried.find("move " + name + " ") == 0) field = name + "_deg";
      }
    }
    InputLocation where = origin.where;
    if (where.field.empty() && !origin.is_listed) where.field = "geometry";
    const bool needs_dot = !where.field.empty() && !field.empty();
    where.field += (needs_dot ? "." : "") + field;
    error.device = "plan";
    error.where = std::move(where);
    return error;
  }

  Result<PlannedScan> finish(const api::Plan& plan) {
    for (const ScanPoint& point : planned_.points) planned_.blocked += point.blocked ? 1 : 0;
    const auto count = static_cast<std::int64_t>(planned_.points.size());
    if (planned_.blocked == count) {
      return failure(
          Error{.code = ErrorCode::AllPointsBlocked,
                .device = "plan",
                .tried = fmt::format("plan {} points", count),
                .seen = "every one in the shadow of the detector's head, or with the arms against each other",
                .limit = "at least one point outside of the keep-out about retro-reflection",
                .where = InputLocation{.field = "geometry"}});
    }
    planned_.planner_version = kPlannerVersion;
    planned_.items = items_of(count - planned_.blocked, plan.reference_mode);
    auto ordered = measuring_order(plan, instrument_, planned_.points, experience_);
    if (!ordered) return failure(ordered.error());
    planned_.order = std::move(ordered->order);
    planned_.estimate = ordered->time;
    planned_.experience = experience_;
    planned_.u_estimate_s = u_of_estimate_s(plan, instrument_, planned_);
    std::int32_t rank = 0;
    for (const std::int32_t index : planned_.order) planned_.points[static_cast<std::size_t>(index)].rank = rank++;
    for (ScanPoint& point : planned_.points) {
      if (point.blocked) point.rank = rank++;
    }
    return std::move(planned_);
  }

  const api::Plan& plan_;
  const Instrument& instrument_;
  const TimeExperience& experience_;
  const bool is_relative_;
  const stage::PerAxis<double> home_ = home_position(instrument_);
  DirectionIndex known_;
  std::vector<int> repeats_;  ///< of each point, while each stands once
  struct WantedBy {
    int part = 0;
    int unit = 0;
    int level = -1;
  };
  std::vector<WantedBy> wanted_by_;  ///< likewise
  std::map<std::pair<int, int>, int> level_units_;
  int part_ = 0;            ///< of what is being taken
  WantedBy wanted_by_now_;  ///< likewise
  int last_unit_ = 0;
  PlannedScan planned_;
};

}  // namespace

Result<PlannedScan> expand(const api::Plan& plan, const Instrument& instrument, const TimeExperience& experience) {
  if (instrument.detector.power && !plan.exposures.empty()) {
    return failure(Error{.code = ErrorCode::InvalidInput,
                         .device = "plan",
                         .tried = "find the detector's exposure for a stated one",
                         .seen = "the detector is a radiometer",
                         .limit = "no stated exposures: it has ranges, which are chosen",
                         .where = InputLocation{.field = "reading.exposure_s"}});
  }
  if (instrument.detector.power && plan.calibration && api::makes_maps(plan.calibration->job)) {
    return failure(Error{.code = ErrorCode::InvalidInput,
                         .device = "plan",
                         .tried = "make maps of the detector's pixels",
                         .seen = "the detector is a radiometer",
                         .limit = "a camera",
                         .where = InputLocation{.field = "calibration.job"}});
  }
  GONIO_TRY(rungs_of(plan.exposures, exposure_ladder(instrument.detector, plan.max_time)));
  return Expansion(plan, instrument, experience).run();
}

}  // namespace gonio::daemon
