#include "daemon/planner/estimate.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "daemon/planner/exposure_ladder.h"
#include "daemon/planner/planner.h"
#include "drivers/motion/route.h"
#include "drivers/motion/route_time.h"
#include "drivers/motion/travel_time.h"

namespace gonio::daemon {

namespace {

using stage::Axis;

// Of one frame beyond its exposure: transfer, reduction, the look at the gate. Only the estimate uses it.
constexpr Duration kReadTime = std::chrono::milliseconds(5);
constexpr int kDarkFrames = 4;  // of each rung, in the estimate

Error at_point(const ScanPoint& point, Error error) {
  const Geometry& g = point.geometry;
  error.device = "plan";
  error.tried = fmt::format("come to point {} (theta_i {:g}, theta_r {:g}, phi_r {:g} deg): {}", point.index,
                            in_degrees(g.theta_i), in_degrees(g.theta_r), in_degrees(g.phi_r), error.tried);
  error.where = InputLocation{.field = "geometry"};
  return error;
}

class Walk {
 public:
  Walk(const api::Plan& plan, const Instrument& instrument)
      : plan_(plan), instrument_(instrument), standing_(home_position(instrument)) {
    const std::vector<Duration> ladder = exposure_ladder(instrument.detector, plan.max_time);
    exposure_ = seconds(std::sqrt(in_seconds(ladder.front()) * in_seconds(ladder.back())));
    if (!plan.exposures.empty()) {
      exposure_ = std::accumulate(plan.exposures.begin(), plan.exposures.end(), Duration{});
      frames_ = static_cast<int>(plan.exposures.size());
    }
    dark_exposures_ = std::accumulate(ladder.begin(), ladder.end(), Duration{});
    rungs_ = static_cast<int>(ladder.size());
    visit_dark();
  }

  Result<void> visit(const ScanPoint& point, Length carriage) {
    auto target = axis_targets(point.geometry, point.wavelength, instrument_, standing_);
    assert(target);  // the planner has checked every direction
    (*target)[stage::index_of(Axis::Carriage)] = in_millimetres(carriage);
    const auto step = step_time(instrument_, standing_, *target);
    if (!step) return failure(at_point(point, step.error()));
    time_.move += step->move;
    time_.settle += step->settle;
    time_.expose += exposure_;
    time_.read += frames_ * kReadTime;
    for (std::size_t a = 0; a < stage::kAxisCount; ++a) standing_[a] = (*target)[a].value_or(standing_[a]);
    if (plan_.dark_every > Duration::zero() && time_.total() - last_dark_ >= plan_.dark_every) visit_dark();
    return {};
  }

  void visit_dark() {
    time_.expose += kDarkFrames * dark_exposures_;
    time_.read += kDarkFrames * rungs_ * kReadTime;
    last_dark_ = time_.total();
  }

  [[nodiscard]] const TimeParts& time() const { return time_; }

 private:
  const api::Plan& plan_;
  const Instrument& instrument_;
  stage::PerAxis<double> standing_;
  Duration exposure_{};
  Duration dark_exposures_{};
  int rungs_ = 1;
  int frames_ = 1;  // of an item
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
                           std::span<const std::int32_t> order) {
  Walk walk(plan, instrument);
  const Duration pass = plan.block / 2;  // there and back: partners lie within the whole block
  for (std::size_t first = 0; first < order.size();) {
    const Duration started = walk.time().total();
    std::size_t end = first;
    while (end < order.size() && (end == first || walk.time().total() - started < pass)) {
      GONIO_TRY(walk.visit(points[static_cast<std::size_t>(order[end])], instrument.carriage.sample));
      ++end;
    }
    for (std::size_t k = end; k-- > first;) {
      GONIO_TRY(walk.visit(points[static_cast<std::size_t>(order[k])], instrument.carriage.reference));
    }
    first = end;
  }
  walk.visit_dark();
  return walk.time();
}

}  // namespace gonio::daemon
