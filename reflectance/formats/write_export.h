#pragma once

#include <string>

#include "base/result.h"
#include "reflectance/formats/export_files.h"

namespace gonio::formats {

/// All files of an export beside each other, each whole or not at all (base/write_file.h); the first to fail ends it,
/// and those written before stay. Errors: DiskFull, InvalidInput.
[[nodiscard]] Result<void> write_export(const std::string& stem, const Export& written);

}  // namespace gonio::formats
