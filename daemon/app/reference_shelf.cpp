#include "daemon/app/reference_shelf.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
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
  if (!standard) return {file, std::move(text), std::move(standard)};
  calibration::ShapeReport shape = calibration::check_shape(*standard);
  const Result<void> consistent = calibration::demand_consistency(*standard, shape);
  if (!consistent) standard = failure(consistent.error());
  return {file, std::move(text), std::move(standard), std::move(shape)};
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

// 0, or errno.
int write_durably(const std::string& path, const std::string& text) {
  constexpr mode_t kMode = 0644;
  const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kMode);
  if (fd < 0) return errno;
  int reason = 0;
  for (std::size_t done = 0; done < text.size() && reason == 0;) {
    const ssize_t n = write(fd, text.data() + done, text.size() - done);
    if (n > 0) {
      done += static_cast<std::size_t>(n);
    } else if (n == 0 || errno != EINTR) {
      reason = n == 0 ? EIO : errno;
    }
  }
  if (reason == 0 && fsync(fd) != 0) reason = errno;
  close(fd);
  return reason;
}

// The renames outlive a power cut only with their folder.
void sync_folder_of(const std::string& path) {
  const int fd = open(fs::path(path).parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  fsync(fd);
  close(fd);
}

Result<void> rename_into_place(const std::string& serial, const std::string& path, const std::string& text,
                               const std::string& keep_old_as) {
  const std::string aside = path + ".part-" + std::to_string(getpid());
  int reason = write_durably(aside, text);
  // A second name for the old text: the file itself is never gone.
  if (reason == 0 && !keep_old_as.empty() && link(path.c_str(), keep_old_as.c_str()) != 0) reason = errno;
  if (reason == 0 && rename(aside.c_str(), path.c_str()) != 0) reason = errno;
  if (reason == 0) {
    sync_folder_of(path);
    return {};
  }
  unlink(aside.c_str());
  return failure(not_put(reason == ENOSPC || reason == EDQUOT ? ErrorCode::DiskFull : ErrorCode::InvalidInput, serial,
                         path + ": " + std::strerror(reason), "a folder that the daemon may write to"));
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
  GONIO_TRY(rename_into_place(serial, path, text, kept));
  return is_there ? "it replaces the text that is kept as " + kept : "written to " + path;
}

}  // namespace gonio::daemon
