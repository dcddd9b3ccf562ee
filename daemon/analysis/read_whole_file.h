#pragma once

#include <string>

#include "base/result.h"

namespace gonio::analysis {

/// All bytes of a file of at most 2 GiB. Errors: FileUnreadable, TooLarge.
[[nodiscard]] Result<std::string> read_whole_file(const std::string& path);

}  // namespace gonio::analysis
