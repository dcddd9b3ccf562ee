#pragma once

#include <span>

#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::drivers {

/// Where the axes stand after a leg.
[[nodiscard]] stage::PerAxis<double> after(const stage::PerAxis<double>& from, const MotionTarget& leg);

/// How long the legs take one after the other, each from rest to rest as long as its slowest axis; without settling.
[[nodiscard]] Duration route_time(const StageConfig& config, stage::PerAxis<double> from,
                                  std::span<const MotionTarget> legs);

}  // namespace gonio::drivers
