#pragma once

#include <string>

#include "base/result.h"
#include "reflectance/formats/export_files.h"

namespace gonio::formats {

/// All files of an export beside each other: all of them, or none and what was there before (base/write_file.h,
/// write_files). Errors: those of write_files.
[[nodiscard]] Result<void> write_export(const std::string& stem, const Export& written);

}  // namespace gonio::formats
