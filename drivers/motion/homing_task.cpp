#include "drivers/motion/homing_task.h"

#include <fmt/format.h>

#include <algorithm>

namespace gonio::drivers {
namespace {

constexpr Duration kHomingPoll = std::chrono::milliseconds(20);

bool is_home(const AxisState& axis) {
  return axis.homed && !axis.moving;
}

}  // namespace

HomingTask::HomingTask(const StageConfig& config, const StageState& before, MotionToken token, Epoch epoch, Instant now)
    : watch_(before, token, epoch, "home all axes"), started_(now), deadline_(now + config.homing_time) {}

Result<MotionProgress> HomingTask::look(const StageState& seen, Instant now) {
  const Result<bool> accepted = watch_.look(seen);
  if (!accepted) return failure(accepted.error());
  const auto astray = std::ranges::find_if_not(seen.axes, is_home);
  if (*accepted && seen.homed && !seen.moving && astray == seen.axes.end()) return MotionProgress{true, now};
  if (now < deadline_) return MotionProgress{false, std::min(now + kHomingPoll, deadline_)};
  std::string where = "the stage does not say that it is homed";
  if (astray != seen.axes.end()) {
    const stage::Axis axis = stage::kAllAxes[static_cast<std::size_t>(astray - seen.axes.begin())];
    where = fmt::format("{} is {}", stage::axis_name(axis), astray->moving ? "still moving" : "not homed");
  }
  return failure(watch_.error(ErrorCode::MotionLate, std::move(where),
                              fmt::format("within {:.3f} s", in_seconds(deadline_ - started_))));
}

}  // namespace gonio::drivers
