#include "daemon/desks/reference_shelf.h"

#include <algorithm>
#include <filesystem>

#include "base/read_file.h"
#include "base/write_file.h"

namespace gonio::daemon {
namespace {

namespace fs = std::filesystem;

ShelfEntry read_entry(const std::string& file) {
  const Result<std::string> bytes = read_file(file);
  if (!bytes) return {file, {}, failure(bytes.error())};
  const std::string& text = *bytes;
  Result<calibration::ReferenceStandard> standard = calibration::ReferenceStandard::parse(text, file);
  if (!standard) return {file, text, std::move(standard)};
  calibration::ShapeReport shape = calibration::check_shape(*standard);
  const Result<void> consistent = calibration::demand_consistency(*standard, shape);
  if (!consistent) standard = failure(consistent.error());
  return {file, text, std::move(standard), std::move(shape)};
}

Error not_put(ErrorCode code, const std::string& serial, std::string seen, std::string limit) {
  return {.code = code,
          .device = {},
          .tried = "put the standard " + serial + " on the shelf",
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

bool is_file_name(const std::string& serial) {
  constexpr std::size_t kLongest = 100;
  const bool is_plain = std::ranges::all_of(serial, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
           c == '.';
  });
  return !serial.empty() && serial.size() <= kLongest && serial.front() != '.' && is_plain;
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

Result<std::string> ReferenceShelf::put(const std::string& serial, const std::string& text, bool replace,
                                        UtcTime now) const {
  if (!is_file_name(serial)) {
    return failure(not_put(ErrorCode::InvalidInput, serial, "a serial number that is no file name",
                           "letters, digits, '-', '_', '.', at most 100"));
  }
  std::error_code ignored;  // what cannot be made cannot be written to either, and that is told
  fs::create_directories(folder_, ignored);
  std::string path = (fs::path(folder_) / (serial + ".toml")).string();
  bool is_there = fs::exists(path, ignored);
  std::string there = is_there ? read_entry(path).text : std::string();
  for (const ShelfEntry& entry : all()) {
    if (!entry.standard || entry.standard->serial() != serial) continue;
    path = entry.file;
    there = entry.text;
    is_there = true;
  }
  if (is_there && there == text) return "it is on the shelf already, word for word: nothing was written";
  if (is_there && !replace) {
    return failure(not_put(ErrorCode::WrongState, serial, path + " has another text",
                           "a new serial number, or --replace: scans keep the text they were accepted with"));
  }
  const std::string kept = is_there ? path + ".until-" + iso8601(now) : std::string();
  const Result<void> written = write_file(path, text, kept);
  if (!written) {
    return failure(not_put(written.error().code, serial, path + ": " + written.error().seen,
                           "a folder that the daemon may write to"));
  }
  return is_there ? "it replaces the text that is kept as " + kept : "written to " + path;
}

}  // namespace gonio::daemon
