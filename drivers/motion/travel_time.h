#pragma once

#include "base/clock.h"

namespace gonio::drivers {

/// The time of a move from rest to rest over `distance`, with trapezoidal speed: acceleration, `speed`, the same
/// deceleration. distance / speed + speed / acceleration when the speed is reached, else 2 sqrt(distance /
/// acceleration). Units of `distance`, per second, per second squared; `speed` and `acceleration` above zero.
[[nodiscard]] Duration travel_time(double distance, double speed, double acceleration);

}  // namespace gonio::drivers
