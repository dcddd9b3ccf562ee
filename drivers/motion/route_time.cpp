#include "drivers/motion/route_time.h"

#include "drivers/motion/leg_axes.h"

namespace gonio::drivers {

stage::PerAxis<double> after(const stage::PerAxis<double>& from, const MotionTarget& leg) {
  stage::PerAxis<double> at = from;
  for (std::size_t a = 0; a < at.size(); ++a) at[a] = leg[a].value_or(at[a]);
  return at;
}

Duration route_time(const StageConfig& config, stage::PerAxis<double> from, std::span<const MotionTarget> legs) {
  Duration total{};
  for (const MotionTarget& leg : legs) {
    total += leg_time(config, from, leg);
    from = after(from, leg);
  }
  return total;
}

}  // namespace gonio::drivers
