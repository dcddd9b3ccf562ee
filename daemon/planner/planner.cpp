#include "daemon/planner/planner.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <utility>

#include "daemon/planner/exposure_ladder.h"
#include "daemon/planner/measuring_order.h"
#include "drivers/motion/route.h"

namespace gonio::daemon {

namespace {

constexpr double kMostPoints = 1e7;       // more is a slip of a plan's author, and would fill the disk with empty rows
constexpr double kSameAngle_rad = 1e-11;  // as written: list values are equal or they are not

bool is_zero(Angle a) {
  return std::abs(a.si()) < kSameAngle_rad;
}

// For each value, the first in the list that means the same.
template <class T, class Same>
std::vector<std::uint32_t> first_of_same(const std::vector<T>& values, Same same) {
  std::vector<std::uint32_t> first(values.size());
  for (std::uint32_t k = 0; k < values.size(); ++k) {
    first[k] = k;
    for (std::uint32_t earlier = 0; earlier < k; ++earlier) {
      if (!same(values[earlier], values[k])) continue;
      first[k] = earlier;
      break;
    }
  }
  return first;
}

// The lists of a product plan, as places in a grid: theta_i, phi_i, theta_r, phi_r, wavelength.
constexpr std::size_t kPlanListCount = 5;
using GridPlace = std::array<std::uint32_t, kPlanListCount>;

// Walks the product of the lists, theta_i slowest, wavelength fastest.
class Expansion {
 public:
  Expansion(const api::Plan& plan, const Instrument& instrument) : plan_(plan), instrument_(instrument) {
    const auto same_angle = [](Angle a, Angle b) { return is_zero(a - b); };
    const auto same_azimuth = [](Angle a, Angle b) { return is_zero(wrapped(a - b)); };
    const auto same_wavelength = [](Wavelength a, Wavelength b) { return a == b; };
    first_ = {first_of_same(plan.theta_i, same_angle), first_of_same(plan.phi_i, same_azimuth),
              first_of_same(plan.theta_r, same_angle), first_of_same(plan.phi_r, same_azimuth),
              first_of_same(plan.wavelengths, same_wavelength)};
    for (std::size_t list = 0; list < kPlanListCount; ++list) {
      sizes_[list] = static_cast<std::uint32_t>(first_[list].size());
    }
  }

  Result<PlannedScan> run() {
    double combinations = 1.0;
    for (const std::uint32_t size : sizes_) combinations *= size;
    if (combinations < 1.0 || combinations > kMostPoints) {
      return failure(Error{.code = ErrorCode::InvalidInput,
                           .device = "plan",
                           .tried = "expand the lists of [geometry]",
                           .seen = fmt::format("{:.0f} points", combinations),
                           .limit = fmt::format("1 to {:.0f} points", kMostPoints),
                           .where = InputLocation{.field = "geometry"}});
    }
    const auto count = static_cast<std::uint64_t>(combinations);
    for (std::uint64_t k = 0; k < count; ++k) {
      GONIO_TRY(take(place_of(k)));
    }
    return finish();
  }

 private:
  [[nodiscard]] GridPlace place_of(std::uint64_t k) const {
    GridPlace place{};
    for (std::size_t list = kPlanListCount; list-- > 0;) {
      place[list] = static_cast<std::uint32_t>(k % sizes_[list]);
      k /= sizes_[list];
    }
    return place;
  }

  // At a pole the azimuth means nothing; an isotropic sample looks the same from all sides, so that there only theta
  // counts.
  [[nodiscard]] bool is_first_of_its_direction(const GridPlace& place) const {
    for (std::size_t list = 0; list < kPlanListCount; ++list) {
      if (first_[list][place[list]] != place[list]) return false;
    }
    const bool at_source_pole = is_zero(plan_.theta_i[place[0]]);
    const bool at_detector_pole = is_zero(plan_.theta_r[place[2]]);
    if (at_detector_pole && place[3] != 0) return false;
    if (!plan_.isotropic) return true;
    if (at_source_pole && place[3] != 0) return false;
    return !((at_source_pole || at_detector_pole) && place[1] != 0);
  }

  Result<void> take(const GridPlace& place) {
    ++planned_.asked;
    if (!is_first_of_its_direction(place)) {
      ++planned_.merged;
      return {};
    }
    const Angle phi_i = plan_.phi_i[place[1]];
    ScanPoint point{.index = static_cast<std::int32_t>(planned_.points.size()),
                    .geometry = {.theta_i = plan_.theta_i[place[0]],
                                 .phi_i = phi_i,
                                 .theta_r = plan_.theta_r[place[2]],
                                 .phi_r = plan_.phi_r[place[3]] + (plan_.isotropic ? phi_i : Angle{})},
                    .wavelength = plan_.wavelengths[place[4]]};
    const auto target = axis_targets(point.geometry, point.wavelength, instrument_, home_);
    if (!target) return failure(named_by_the_plan(target.error(), point.geometry));
    GONIO_TRY(check_approach(*target, point.geometry));
    point.blocked = is_blocked(point.geometry, instrument_);
    planned_.points.push_back(point);
    return {};
  }

  // An axis that turns past its target must be able to, wherever it comes from.
  Result<void> check_approach(const drivers::MotionTarget& target, const Geometry& g) const {
    const auto turns = drivers::check_approach(instrument_.stage, target);
    return turns ? turns : failure(named_by_the_plan(turns.error(), g));
  }

  // The instrument's error, with the field of the plan that asked for it; where no axis is one of the plan's angles,
  // with the direction.
  [[nodiscard]] Error named_by_the_plan(Error error, const Geometry& g) const {
    std::string field = "geometry.wavelength_nm";
    const bool is_direction = error.code == ErrorCode::OutOfLimits;
    if (is_direction && instrument_.stage.kinematics.kind != drivers::KinematicsKind::Arms) {
      field = "geometry";
      error.tried +=
          fmt::format(" for theta_i {:.3f}, phi_i {:.3f}, theta_r {:.3f}, phi_r {:.3f} deg", in_degrees(g.theta_i),
                      in_degrees(g.phi_i), in_degrees(g.theta_r), in_degrees(g.phi_r));
    } else if (is_direction) {
      for (const auto axis : {stage::Axis::ThetaI, stage::Axis::ThetaR, stage::Axis::PhiR, stage::Axis::PhiI}) {
        const std::string name(stage::axis_name(axis));
        if (error.tried.find("move " + name + " ") == 0) field = "geometry." + name + "_deg";
      }
    }
    error.device = "plan";
    error.where = InputLocation{.field = std::move(field)};
    return error;
  }

  Result<PlannedScan> finish() {
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
    planned_.items = 2 * (count - planned_.blocked);
    auto ordered = measuring_order(plan_, instrument_, planned_.points);
    if (!ordered) return failure(ordered.error());
    planned_.order = std::move(ordered->order);
    planned_.estimate = ordered->time;
    std::int32_t rank = 0;
    for (const std::int32_t index : planned_.order) planned_.points[static_cast<std::size_t>(index)].rank = rank++;
    for (ScanPoint& point : planned_.points) {
      if (point.blocked) point.rank = rank++;
    }
    return std::move(planned_);
  }

  const api::Plan& plan_;
  const Instrument& instrument_;
  const stage::PerAxis<double> home_ = home_position(instrument_);
  std::array<std::vector<std::uint32_t>, kPlanListCount> first_;
  GridPlace sizes_{};
  PlannedScan planned_;
};

}  // namespace

Result<PlannedScan> expand(const api::Plan& plan, const Instrument& instrument) {
  if (instrument.detector.power && !plan.exposures.empty()) {
    return failure(Error{.code = ErrorCode::InvalidInput,
                         .device = "plan",
                         .tried = "find the detector's exposure for a stated one",
                         .seen = "the detector is a radiometer",
                         .limit = "no stated exposures: it has ranges, which are chosen",
                         .where = InputLocation{.field = "reading.exposure_s"}});
  }
  GONIO_TRY(rungs_of(plan.exposures, exposure_ladder(instrument.detector, plan.max_time)));
  return Expansion(plan, instrument).run();
}

}  // namespace gonio::daemon
