#pragma once

#include "base/toml_reader.h"
#include "sim/scene/scene.h"

namespace gonio::sim {

/// Reads [stage.kinematics] of a scene. Errors stick in the reader.
void read_kinematics(TomlReader table, StageSpec& stage);

}  // namespace gonio::sim
