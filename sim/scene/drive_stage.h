#pragma once

#include "protocol/stage/drive_stage_map.h"
#include "sim/scene/scene.h"

namespace gonio::sim {

/// The scene's stage as six Lexium 32 drives, units 1 to 6 in the order of the axes, and a coupler, unit 20. Their
/// encoders have the steps of the scene's register map; speeds are wall ones.
[[nodiscard]] stage::DriveStageMap drive_stage_of(const StageSpec& stage);

}  // namespace gonio::sim
