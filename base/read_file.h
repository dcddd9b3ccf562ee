#pragma once

#include <string>

#include "base/result.h"

namespace gonio {

/// The bytes of a file, all of them. Errors: FileUnreadable, with the system's own word (no such file, permission
/// denied, is a directory), at `path`. Threads: any.
[[nodiscard]] Result<std::string> read_file(const std::string& path);

}  // namespace gonio
