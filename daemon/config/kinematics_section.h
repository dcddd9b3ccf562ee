#pragma once

#include "base/toml_reader.h"
#include "drivers/stage_config.h"

namespace gonio::daemon {

/// Reads [stage.kinematics], which may be missing: arms then. Errors stick in `stage_table`: an axis that
/// turns two things, a source so far outside of the plane of the detector's arm that the arm reaches next to nothing.
void read_kinematics(TomlReader& stage_table, drivers::StageConfig& stage);

}  // namespace gonio::daemon
