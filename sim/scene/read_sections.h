#pragma once

#include "base/toml_reader.h"
#include "sim/scene/scene.h"

namespace gonio::sim {

/// Reads every section but [scene] and [sample] into `scene`, each from the scene's own text if it is there, else from
/// `bench` (may be null). Errors stick in the reader of the text that they stand in.
void read_sections(TomlReader& own, TomlReader* bench, Scene& scene);

/// [[radiometers]], if there are any. Errors stick in the reader.
void read_radiometers(TomlReader& root, Scene& scene);

}  // namespace gonio::sim
