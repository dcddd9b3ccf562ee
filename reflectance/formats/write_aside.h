#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "reflectance/formats/export_files.h"

namespace gonio::formats {

/// Writes `path`.part-PID, makes it durable (fsync of file and folder), then renames: the file is there whole or as it
/// was. Blocks for the disk. Errors: DiskFull, InvalidInput (any other reason), each with the system's word.
[[nodiscard]] Result<void> write_aside(const std::string& path, std::string_view bytes);

/// All files of an export beside each other, each as above; the first to fail ends it, and those renamed before stay.
[[nodiscard]] Result<void> write_export(const std::string& stem, const Export& written);

}  // namespace gonio::formats
