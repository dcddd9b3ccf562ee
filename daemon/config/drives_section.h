#pragma once

#include "base/toml_reader.h"
#include "drivers/stage_config.h"

namespace gonio::daemon {

/// Reads what the stage is made of: `kind` of [stage], "goniod" (the usual one) with [stage.registers], or "drives"
/// with [stage.drives]. `stage.axes` must have been read. Errors stick in `table`.
void read_stage_kind(TomlReader& table, drivers::StageConfig& stage);

}  // namespace gonio::daemon
