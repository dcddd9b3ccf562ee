#include "daemon/planner/estimate.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>

#include "daemon/planner/light_forecast.h"
#include "daemon/planner/planner.h"
#include "daemon/planner/visit_place.h"
#include "drivers/motion/route.h"
#include "drivers/motion/route_time.h"
#include "drivers/motion/travel_time.h"

namespace gonio::daemon {

namespace {

using calibration::Target;
using stage::Axis;

// Of each frame after the first, beyond its exposure: transfer, reduction, the look at the gate.
constexpr Duration kReadTime = std::chrono::milliseconds(5);
constexpr int kDarkFrames = 4;  // of each rung
constexpr double kVisitSlack = 0.2;

Error at_point(const ScanPoint& point, Error error) {
  const Geometry& g = point.geometry;
  error.device = "plan";
  error.tried = fmt::format("come to point {} (theta_i {:g}, theta_r {:g}, phi_r {:g} deg): {}", point.index,
                            in_degrees(g.theta_i), in_degrees(g.theta_r), in_degrees(g.phi_r), error.tried);
  error.where = InputLocation{.field = "geometry"};
  return error;
}

// One kind of visit, and when it was last made.
struct VisitDue {
  Duration every{};
  calibration::Target target = calibration::Target::Reference;
  Duration last{};
  [[nodiscard]] bool is_wanted() const { return every > Duration::zero(); }
};

class Walk {
 public:
  Walk(const api::Plan& plan, const Instrument& instrument, std::span<const ScanPoint> points,
       const TimeExperience& experience)
      : plan_(plan),
        instrument_(instrument),
        experience_(experience),
        forecast_(plan, instrument, experience),
        visits_at_(points[static_cast<std::size_t>(visit_point(points))]),
        standing_(home_position(instrument)),
        due_{{{.every = plan.reference_every, .target = Target::Reference},
              {.every = plan.check_every, .target = Target::Sample}}} {}

  // Each run begins with a dark of the whole ladder, then a visit of each kind.
  Result<void> begin() {
    expose_dark(0, forecast_.rungs().size() - 1);
    for (VisitDue& due : due_) {
      if (due.is_wanted()) GONIO_TRY(visit(due));
    }
    return {};
  }

  Result<void> measure(const ScanPoint& point, Target target) {
    GONIO_TRY(make_visits(target));
    GONIO_TRY(go_to(point, target));
    take(forecast_.of(point, target));
    time_.read += seconds(experience_.beyond_s.value);
    return {};
  }

  Result<void> end() {
    for (VisitDue& due : due_) {
      if (due.is_wanted()) GONIO_TRY(visit(due));
    }
    visit_dark();
    return {};
  }

  [[nodiscard]] const TimeParts& time() const { return time_; }

 private:
  // A dark comes when it is due; the others wait up to a fifth of their period for the carriage to be on their side.
  Result<void> make_visits(Target side) {
    const Duration now = time_.total();
    if (plan_.dark_every > Duration::zero() && now - last_dark_ >= plan_.dark_every) visit_dark();
    for (VisitDue& due : due_) {
      if (!due.is_wanted() || now - due.last < due.every) continue;
      const bool may_wait = now - due.last < seconds(in_seconds(due.every) * (1.0 + kVisitSlack));
      if (due.target == side || !may_wait) GONIO_TRY(visit(due));
    }
    return {};
  }

  Result<void> visit(VisitDue& due) {
    GONIO_TRY(go_to(visits_at_, due.target));
    take(forecast_.of_visit(visits_at_, due.target));
    time_.read += seconds(experience_.beyond_s.value);
    due.last = time_.total();
    return {};
  }

  Result<void> go_to(const ScanPoint& point, Target side) {
    auto target = axis_targets(point.geometry, point.wavelength, instrument_, standing_);
    assert(target);  // the planner has checked every direction
    (*target)[stage::index_of(Axis::Carriage)] = in_millimetres(carriage_place(instrument_, side, point.geometry));
    const auto step = step_time(instrument_, standing_, *target);
    if (!step) return failure(at_point(point, step.error()));
    time_.move += seconds(in_seconds(step->move) * experience_.motion.value);
    time_.settle += seconds(in_seconds(step->settle) * experience_.motion.value);
    for (std::size_t a = 0; a < stage::kAxisCount; ++a) standing_[a] = (*target)[a].value_or(standing_[a]);
    return {};
  }

  void take(const LightForecast::Light& light) {
    time_.expose += light.exposure;
    time_.read += (light.frames - 1) * kReadTime;
    if (!light.lowest) return;
    lowest_ = std::min(lowest_.value_or(*light.lowest), *light.lowest);
    highest_ = std::max(highest_.value_or(*light.highest), *light.highest);
  }

  void visit_dark() { expose_dark(lowest_.value_or(0), highest_.value_or(forecast_.rungs().size() - 1)); }

  void expose_dark(std::size_t lowest, std::size_t highest) {
    const bool is_map_job = plan_.calibration && api::makes_maps(plan_.calibration->job);
    const int frames = is_map_job ? plan_.calibration->frames : kDarkFrames;
    for (std::size_t rung = lowest; rung <= highest; ++rung) {
      time_.expose += frames * forecast_.rungs()[rung];
      time_.read += frames * kReadTime;
    }
    last_dark_ = time_.total();
  }

  const api::Plan& plan_;
  const Instrument& instrument_;
  const TimeExperience& experience_;
  const LightForecast forecast_;
  const ScanPoint& visits_at_;
  stage::PerAxis<double> standing_;
  std::array<VisitDue, 2> due_;
  std::optional<std::size_t> lowest_;  ///< rungs in use, as far as they are foreseen
  std::optional<std::size_t> highest_;
  TimeParts time_;
  Duration last_dark_{};
};

}  // namespace

Duration travel_time(const drivers::AxisConfig& axis, double way) {
  return drivers::travel_time(std::abs(way), axis.speed, axis.acceleration);
}

Result<StepTime> step_time(const Instrument& instrument, const stage::PerAxis<double>& from,
                           const drivers::MotionTarget& to) {
  drivers::SlackTakenUp taken_up{};
  taken_up.fill(true);
  const auto legs = drivers::plan_route(instrument.stage, from, to, taken_up);
  if (!legs) return failure(legs.error());
  StepTime step{.move = drivers::route_time(instrument.stage, from, *legs)};
  for (const Axis axis : stage::kAllAxes) {
    const std::size_t a = stage::index_of(axis);
    const bool moves = (to[a] && *to[a] != from[a]) || (legs->size() > 1 && legs->back()[a]);
    if (moves) step.settle = std::max(step.settle, instrument.stage.axis(axis).settle);
  }
  return step;
}

Result<TimeParts> estimate(const api::Plan& plan, const Instrument& instrument, std::span<const ScanPoint> points,
                           std::span<const std::int32_t> order, const TimeExperience& experience) {
  Walk walk(plan, instrument, points, experience);
  GONIO_TRY(walk.begin());
  if (plan.reference_mode != api::ReferenceMode::SameGeometry) {  // the standard is visited, or not needed
    for (const std::int32_t index : order) {
      GONIO_TRY(walk.measure(points[static_cast<std::size_t>(index)], Target::Sample));
    }
    GONIO_TRY(walk.end());
    return walk.time();
  }
  const Duration pass = plan.block / 2;  // there and back: partners lie within the whole block
  for (std::size_t first = 0; first < order.size();) {
    const Duration started = walk.time().total();
    std::size_t end = first;
    while (end < order.size() && (end == first || walk.time().total() - started < pass)) {
      GONIO_TRY(walk.measure(points[static_cast<std::size_t>(order[end])], Target::Sample));
      ++end;
    }
    for (std::size_t k = end; k-- > first;) {
      GONIO_TRY(walk.measure(points[static_cast<std::size_t>(order[k])], Target::Reference));
    }
    first = end;
  }
  GONIO_TRY(walk.end());
  return walk.time();
}

double u_of_estimate_s(const api::Plan& plan, const Instrument& instrument, const PlannedScan& planned) {
  constexpr double kForeseen = 0.1;  // of light that is foreseen from a stated reflectance: relative
  const LightForecast forecast(plan, instrument, planned.experience);
  const auto items = static_cast<double>(planned.items);
  const bool is_known = std::ranges::all_of(planned.order, [&](std::int32_t point) {
    return forecast.is_known(planned.points[static_cast<std::size_t>(point)]);
  });
  const bool is_foreseen = is_known && forecast.u_guess_s() > 0.0;
  const double u_light_s = is_foreseen ? kForeseen * in_seconds(planned.estimate.expose)
                           : is_known  ? 0.0
                                       : items * forecast.u_guess_s();
  const double motion_s = in_seconds(planned.estimate.move + planned.estimate.settle);
  const TimeExperience& experience = planned.experience;
  return std::hypot(u_light_s, motion_s * experience.motion.u / experience.motion.value, items * experience.beyond_s.u);
}

}  // namespace gonio::daemon
