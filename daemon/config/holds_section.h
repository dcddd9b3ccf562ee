#pragma once

#include <optional>

#include "base/toml_reader.h"
#include "daemon/config/holds.h"

namespace gonio::daemon {

/// Reads [holds], which may be missing: then the operator ends every hold. Errors stick in `root`.
[[nodiscard]] HoldRules read_holds(TomlReader& root);

/// Reads [lamp.warm_up], which may be missing: then every lamp is warm. Errors stick in `lamp_table`.
[[nodiscard]] std::optional<LampWarmUp> read_warm_up(TomlReader& lamp_table);

}  // namespace gonio::daemon
