#include "reflectance/formats/write_export.h"

#include "base/write_file.h"

namespace gonio::formats {

Result<void> write_export(const std::string& stem, const Export& written) {
  for (const OutputFile& file : written.files) GONIO_TRY(write_file(stem + file.suffix, file.bytes));
  return {};
}

}  // namespace gonio::formats
