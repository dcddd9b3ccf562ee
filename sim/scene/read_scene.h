#pragma once

#include <string>

#include "base/result.h"
#include "sim/scene/scene.h"

namespace gonio::sim {

/// Reads a scene file. A section that the scene does not have ([source], [detector], [stage], [angles], [reference],
/// [environment], [[filters]]) comes from the bench that it names: `bench = "bench.toml"` in [scene], beside the scene.
/// Strict: errors name file, line and field. Errors: FileUnreadable, InvalidInput, UnknownKey, MissingKey.
[[nodiscard]] Result<Scene> read_scene(const std::string& path);

}  // namespace gonio::sim
