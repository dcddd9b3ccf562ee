#include "drivers/motion/route.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "drivers/keep_out/detour.h"
#include "drivers/keep_out/path_conflict.h"
#include "drivers/motion/move_task.h"
#include "drivers/motion/route_time.h"

namespace gonio::drivers {
namespace {

using stage::Axis;
using Legs = std::vector<MotionTarget>;

// Where an axis goes past its target to, so that it arrives from its side; nothing when any side will do.
std::optional<double> turning_point(const AxisConfig& axis, double target) {
  if (axis.approach == Approach::Any) return std::nullopt;
  return axis.approach == Approach::FromBelow ? target - axis.overrun : target + axis.overrun;
}

// Encoders end a move a count beside it: so little is no way from the wrong side.
bool arrives_from_its_side(const AxisConfig& axis, double from, double to, bool slack_is_taken_up) {
  const double along = axis.approach == Approach::FromBelow ? to - from : from - to;
  return slack_is_taken_up ? along >= -axis.window : along >= axis.overrun;
}

// The target, with every axis that needs it (or `all` that have a side) at its turning point. True if one is.
bool put_turning_points(const StageConfig& config, const stage::PerAxis<double>& from, const SlackTakenUp& taken_up,
                        bool all, MotionTarget& target) {
  bool any = false;
  for (std::size_t a = 0; a < target.size(); ++a) {
    if (!target[a]) continue;
    const AxisConfig& axis = config.axes[a];
    const auto point = turning_point(axis, *target[a]);
    if (!point || (!all && arrives_from_its_side(axis, from[a], *target[a], taken_up[a]))) continue;
    target[a] = *point;
    any = true;
  }
  return any;
}

Error blocked(const StageConfig& config, const MotionTarget& target, const PathConflict& conflict) {
  const auto at = [&](Axis axis) { return conflict.at[stage::index_of(axis)]; };
  return {.code = ErrorCode::Blocked,
          .device = "stage",
          .tried = motion_text(target),
          .seen = fmt::format(
              "the arms come to {:.3f} deg of each other on the way, at theta_i {:.3f}, theta_r {:.3f}, "
              "phi_r {:.3f}, phi_i {:.3f} deg",
              in_degrees(conflict.separation), at(Axis::ThetaI), at(Axis::ThetaR), at(Axis::PhiR), at(Axis::PhiI)),
          .limit = fmt::format("at least {:.3f} deg, and no way round was found",
                               in_degrees(config.keep_out->least_separation()))};
}

// A way round may move an axis that nobody named: it is then to come back to where it stands, from its own side.
MotionTarget with_turning_axes(MotionTarget target, const stage::PerAxis<double>& standing) {
  for (const Axis axis : {Axis::ThetaI, Axis::ThetaR, Axis::PhiR, Axis::PhiI}) {
    const std::size_t a = stage::index_of(axis);
    target[a] = target[a].value_or(standing[a]);
  }
  return target;
}

// The direct way, or legs round what is in it.
Result<Legs> clear_way(const StageConfig& config, const stage::PerAxis<double>& from, const MotionTarget& to) {
  const auto conflict = path_conflict(config, from, to);
  if (!conflict) return Legs{to};
  auto legs = detour(config, from, to);
  if (!legs) return failure(blocked(config, to, *conflict));
  return *std::move(legs);
}

}  // namespace

Result<void> check_approach(const StageConfig& config, const MotionTarget& target) {
  for (const Axis axis : stage::kAllAxes) {
    const auto& wanted = target[stage::index_of(axis)];
    const AxisConfig& how = config.axis(axis);
    const auto point = wanted ? turning_point(how, *wanted) : std::nullopt;
    if (!point || (*point >= how.low && *point <= how.high)) continue;
    const auto unit = stage::axis_unit(axis);
    return failure({.code = ErrorCode::OutOfLimits,
                    .device = "stage",
                    .tried = fmt::format("move {} to {:.3f} {} {}", stage::axis_name(axis), *wanted, unit,
                                         how.approach == Approach::FromBelow ? "from below" : "from above"),
                    .seen = fmt::format("it would turn at {:.3f} {}", *point, unit),
                    .limit = fmt::format("{:.3f} to {:.3f} {}", how.low, how.high, unit)});
  }
  return {};
}

Result<Legs> plan_route(const StageConfig& config, const stage::PerAxis<double>& standing, const MotionTarget& target,
                        const SlackTakenUp& slack_taken_up) {
  GONIO_TRY(check_approach(config, target));
  MotionTarget turning = target;
  const bool turns = put_turning_points(config, standing, slack_taken_up, false, turning);
  const auto conflict = turns ? std::nullopt : path_conflict(config, standing, target);
  if (!turns && !conflict) return Legs{target};
  // A way round may bring any axis from the wrong side: all that have a side then turn before they arrive.
  const bool is_blocked = turns ? path_conflict(config, standing, turning).has_value() : true;
  bool has_last = turns;
  if (is_blocked) {
    turning = with_turning_axes(target, standing);
    has_last = put_turning_points(config, standing, slack_taken_up, true, turning);
  }
  Result<Legs> legs = clear_way(config, standing, turning);
  if (!legs || !has_last) return legs;
  const MotionTarget last = is_blocked ? with_turning_axes(target, standing) : target;
  if (const auto in_the_way = path_conflict(config, after(standing, legs->back()), last)) {
    return failure(blocked(config, target, *in_the_way));
  }
  legs->push_back(last);
  return legs;
}

}  // namespace gonio::drivers
