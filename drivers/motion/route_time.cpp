#include "drivers/motion/route_time.h"

#include <algorithm>

#include "drivers/motion/travel_time.h"

namespace gonio::drivers {

stage::PerAxis<double> after(const stage::PerAxis<double>& from, const MotionTarget& leg) {
  stage::PerAxis<double> at = from;
  for (std::size_t a = 0; a < at.size(); ++a) at[a] = leg[a].value_or(at[a]);
  return at;
}

Duration route_time(const StageConfig& config, stage::PerAxis<double> from, std::span<const MotionTarget> legs) {
  Duration total{};
  for (const MotionTarget& leg : legs) {
    const stage::PerAxis<double> to = after(from, leg);
    Duration slowest{};
    for (std::size_t a = 0; a < to.size(); ++a) {
      if (to[a] == from[a]) continue;
      slowest = std::max(slowest, travel_time(to[a] - from[a], config.axes[a].speed, config.axes[a].acceleration));
    }
    total += slowest;
    from = to;
  }
  return total;
}

}  // namespace gonio::drivers
