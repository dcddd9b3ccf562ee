#pragma once

#include "base/clock.h"
#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::drivers {

/// The axes as they go on one leg from rest at `from`: as configured, or, where moves are coordinated, each slowed so
/// that all that move start and arrive together and their way is a straight line in axis space:
///   position_a = from_a + s(t) way_a,  |ds/dt| <= min_a speed_a / |way_a|,  |d2s/dt2| <= min_a acceleration_a /
///   |way_a|,
/// the soonest such way. It takes as long as the slowest axis alone, or longer where one axis limits the speed and
/// another the acceleration.
[[nodiscard]] stage::PerAxis<AxisConfig> axes_on_leg(const StageConfig& config, const stage::PerAxis<double>& from,
                                                     const MotionTarget& leg);

/// How long the leg takes, from rest to rest; without settling.
[[nodiscard]] Duration leg_time(const StageConfig& config, const stage::PerAxis<double>& from, const MotionTarget& leg);

}  // namespace gonio::drivers
