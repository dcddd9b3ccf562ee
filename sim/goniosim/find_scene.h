#pragma once

#include <string>

#include "base/result.h"

namespace gonio::sim {

/// The file of a scene: `scene` itself when it is a file, else NAME.toml in the folder `scenes` beside the executable,
/// or in ../share/goniod/scenes of an installation. Errors: FileUnreadable, with the names that exist.
[[nodiscard]] Result<std::string> find_scene(const std::string& scene, const std::string& executable);

/// The path of this very program.
[[nodiscard]] std::string this_executable();

}  // namespace gonio::sim
