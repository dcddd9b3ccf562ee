#include "daemon/app/reference_shelf.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace gonio::daemon {
namespace {

namespace fs = std::filesystem;

ShelfEntry read_entry(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (!in.good() && !in.eof()) {
    return {file,
            {},
            failure({.code = ErrorCode::FileUnreadable,
                     .tried = "open the reference standard's file",
                     .seen = "it may not be read",
                     .where = InputLocation{file, 0, ""}})};
  }
  Result<calibration::ReferenceStandard> standard = calibration::ReferenceStandard::parse(text, file);
  return {file, std::move(text), std::move(standard)};
}

}  // namespace

std::vector<ShelfEntry> ReferenceShelf::all() const {
  std::vector<std::string> files;
  std::error_code missing;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, missing)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path().string());
  }
  std::ranges::sort(files);
  std::vector<ShelfEntry> entries;
  for (const std::string& file : files) entries.push_back(read_entry(file));
  return entries;
}

Result<ShelfEntry> ReferenceShelf::find(const std::string& serial) const {
  std::string known;
  for (ShelfEntry& entry : all()) {
    if (entry.standard && entry.standard->serial() == serial) return std::move(entry);
    // A file that cannot be read is the one that is meant when it bears the name.
    if (!entry.standard && fs::path(entry.file).stem() == serial) return failure(entry.standard.error());
    if (entry.standard) known += (known.empty() ? "" : ", ") + entry.standard->serial();
  }
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = "find the reference standard",
                  .seen = "there is no standard \"" + serial + "\" in " + folder_,
                  .limit = known.empty() ? "a file reference/*.toml with this serial number" : "one of: " + known});
}

}  // namespace gonio::daemon
