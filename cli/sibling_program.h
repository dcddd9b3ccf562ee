#pragma once

#include <string>
#include <vector>

#include "base/result.h"

namespace gonio::cli {

/// The path of a program of this house that lies in the same folder as the one at `own_path`.
[[nodiscard]] std::string sibling_program(const std::string& name, const std::string& own_path);

/// Where this process's own program lies.
[[nodiscard]] std::string own_program();

/// Becomes `command`, whose first word is a program's path: output and exit code are that program's. Returns only when
/// that failed. Errors: FileUnreadable, with `tried` as what was tried.
[[nodiscard]] Error become_program(const std::vector<std::string>& command, const std::string& tried);

}  // namespace gonio::cli
