#pragma once

#include "base/toml_reader.h"
#include "sim/scene/scene.h"

namespace gonio::sim {

/// Reads [effects]: one table an effect, strict. Errors stick in the reader.
void read_effects(TomlReader table, Scene& scene);
/// Reads [told].
void read_told(TomlReader table, ToldSpec& told);

}  // namespace gonio::sim
