#pragma once

#include <string>
#include <string_view>

#include "base/result.h"

namespace gonio {

/// Writes `path`.part-PID, makes it durable (fsync of file and folder), then renames: the file is there whole or as it
/// was. With `keep_old_as` the text that it replaces keeps that name too. Blocks for the disk. Errors: DiskFull,
/// InvalidInput (any other reason), each with the system's word, at `path`. Threads: any, for different paths.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view bytes,
                                      const std::string& keep_old_as = {});

}  // namespace gonio
