#pragma once

#include <string>

#include "base/result.h"

namespace gonio::cli {

/// Errors: FileUnreadable.
[[nodiscard]] Result<std::string> read_text(const std::string& path);
/// Writes aside, then renames: the file is there whole or not at all. Errors: InvalidInput with the reason.
[[nodiscard]] Result<void> write_text(const std::string& path, const std::string& text);

}  // namespace gonio::cli
