#include "base/write_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace gonio {
namespace {

Error unwritten_file(const std::string& path, int reason) {
  return {.code = reason == ENOSPC || reason == EDQUOT ? ErrorCode::DiskFull : ErrorCode::InvalidInput,
          .tried = "write the file",
          .seen = std::strerror(reason),
          .where = InputLocation{path, 0, ""}};
}

// 0, or errno.
int write_all_durably(int fd, std::string_view bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = write(fd, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n == 0 ? EIO : errno;
    done += static_cast<std::size_t>(n);
  }
  return fsync(fd) == 0 ? 0 : errno;
}

// The rename itself outlives a power cut only with its folder. A file system that refuses leaves the file whole.
void sync_folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const int fd = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  fsync(fd);
  close(fd);
}

std::string aside_of(const std::string& path) {
  return path + ".part-" + std::to_string(getpid());
}

// Durable beside `path`. 0, or errno; then nothing is left of it.
int write_aside(const std::string& path, std::string_view bytes) {
  constexpr mode_t kMode = 0644;
  const std::string aside = aside_of(path);
  const int fd = open(aside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kMode);
  if (fd < 0) return errno;
  int reason = write_all_durably(fd, bytes);
  if (close(fd) != 0 && reason == 0) reason = errno;
  if (reason != 0) unlink(aside.c_str());
  return reason;
}

// 0, or errno; then what stands aside is gone.
int take_place(const std::string& path, const std::string& keep_old_as) {
  const std::string aside = aside_of(path);
  int reason = 0;
  // A second name for the old text: the file itself is never gone.
  if (!keep_old_as.empty() && link(path.c_str(), keep_old_as.c_str()) != 0) reason = errno;
  if (reason == 0 && rename(aside.c_str(), path.c_str()) != 0) reason = errno;
  if (reason == 0) sync_folder_of(path);
  if (reason != 0) unlink(aside.c_str());
  return reason;
}

void drop_asides(const std::vector<FileToWrite>& files) {
  for (const FileToWrite& file : files) unlink(aside_of(file.path).c_str());
}

}  // namespace

Result<void> write_file(const std::string& path, std::string_view bytes, const std::string& keep_old_as) {
  int reason = write_aside(path, bytes);
  if (reason == 0) reason = take_place(path, keep_old_as);
  if (reason == 0) return {};
  return failure(unwritten_file(path, reason));
}

Result<void> write_files(const std::vector<FileToWrite>& files) {
  for (const FileToWrite& file : files) {
    const int reason = std::filesystem::is_directory(file.path) ? EISDIR : write_aside(file.path, file.bytes);
    if (reason == 0) continue;
    drop_asides(files);
    return failure(unwritten_file(file.path, reason));
  }
  for (const FileToWrite& file : files) {
    const int reason = take_place(file.path, {});
    if (reason == 0) continue;
    drop_asides(files);
    return failure(unwritten_file(file.path, reason));
  }
  return {};
}

}  // namespace gonio
