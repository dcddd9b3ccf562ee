#include "drivers/motion/travel_time.h"

#include <cmath>

namespace gonio::drivers {

Duration travel_time(double distance, double speed, double acceleration) {
  const double length = std::abs(distance);
  const double ramps = speed * speed / acceleration;  // length of both ramps together
  return seconds(length >= ramps ? length / speed + speed / acceleration : 2.0 * std::sqrt(length / acceleration));
}

}  // namespace gonio::drivers
