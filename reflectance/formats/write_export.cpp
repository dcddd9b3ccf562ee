#include "reflectance/formats/write_export.h"

#include "base/write_file.h"

namespace gonio::formats {

Result<void> write_export(const std::string& stem, const Export& written) {
  std::vector<FileToWrite> files;
  for (const OutputFile& file : written.files) files.push_back({.path = stem + file.suffix, .bytes = file.bytes});
  return write_files(files);
}

}  // namespace gonio::formats
