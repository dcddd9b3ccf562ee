#include "drivers/motion/leg_axes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "drivers/motion/travel_time.h"

namespace gonio::drivers {

stage::PerAxis<AxisConfig> axes_on_leg(const StageConfig& config, const stage::PerAxis<double>& from,
                                       const MotionTarget& leg) {
  stage::PerAxis<AxisConfig> axes = config.axes;
  if (!config.coordinated) return axes;
  const auto way = [&](std::size_t a) { return std::abs(leg[a].value_or(from[a]) - from[a]); };
  double speed = std::numeric_limits<double>::infinity();  // of s, per second
  double acceleration = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (way(a) == 0.0) continue;
    speed = std::min(speed, axes[a].speed / way(a));
    acceleration = std::min(acceleration, axes[a].acceleration / way(a));
  }
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (way(a) == 0.0) continue;
    axes[a].speed = speed * way(a);
    axes[a].acceleration = acceleration * way(a);
  }
  return axes;
}

Duration leg_time(const StageConfig& config, const stage::PerAxis<double>& from, const MotionTarget& leg) {
  const stage::PerAxis<AxisConfig> axes = axes_on_leg(config, from, leg);
  Duration slowest{};
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (!leg[a] || *leg[a] == from[a]) continue;
    slowest = std::max(slowest, travel_time(*leg[a] - from[a], axes[a].speed, axes[a].acceleration));
  }
  return slowest;
}

}  // namespace gonio::drivers
