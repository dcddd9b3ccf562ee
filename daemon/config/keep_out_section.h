#pragma once

#include "base/toml_reader.h"
#include "drivers/stage_config.h"

namespace gonio::daemon {

/// Reads [stage.keep_out] with its tables `source` and `detector`, which may be missing: the arms then pass each other
/// anywhere. Errors stick in `stage_table`.
void read_keep_out(TomlReader& stage_table, drivers::StageConfig& stage);

}  // namespace gonio::daemon
