#include "reflectance/formats/write_aside.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace gonio::formats {
namespace {

Error write_error(const std::string& path, int reason) {
  return {.code = reason == ENOSPC || reason == EDQUOT ? ErrorCode::DiskFull : ErrorCode::InvalidInput,
          .tried = "write the file",
          .seen = std::strerror(reason),
          .where = InputLocation{path, 0, ""}};
}

// 0, or errno.
int write_durably(int fd, std::string_view bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = write(fd, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n == 0 ? EIO : errno;
    done += static_cast<std::size_t>(n);
  }
  return fsync(fd) == 0 ? 0 : errno;
}

// The rename itself outlives a power cut only with its folder. A file system that refuses leaves the file whole.
void sync_folder(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const int fd = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  fsync(fd);
  close(fd);
}

}  // namespace

Result<void> write_aside(const std::string& path, std::string_view bytes) {
  const std::string aside = path + ".part-" + std::to_string(getpid());
  constexpr mode_t kMode = 0644;
  const int fd = open(aside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kMode);
  if (fd < 0) return failure(write_error(path, errno));
  int reason = write_durably(fd, bytes);
  if (close(fd) != 0 && reason == 0) reason = errno;
  if (reason == 0 && rename(aside.c_str(), path.c_str()) != 0) reason = errno;
  if (reason == 0) {
    sync_folder(path);
    return {};
  }
  unlink(aside.c_str());
  return failure(write_error(path, reason));
}

Result<void> write_export(const std::string& stem, const Export& written) {
  for (const OutputFile& file : written.files) GONIO_TRY(write_aside(stem + file.suffix, file.bytes));
  return {};
}

}  // namespace gonio::formats
