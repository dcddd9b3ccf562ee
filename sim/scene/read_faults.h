#pragma once

#include "base/toml_reader.h"
#include "sim/faults/fault_plan.h"

namespace gonio::sim {

/// The tables [[faults]] of a scene, each with a name and what sim/faults/fault_table.h lets it have. Errors stick to
/// the reader.
[[nodiscard]] FaultPlan read_faults(TomlReader& root);

}  // namespace gonio::sim
