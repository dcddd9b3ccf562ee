#include "cli/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "base/read_file.h"

namespace gonio::cli {
namespace {

Error write_error(const std::string& path) {
  return {.code = ErrorCode::InvalidInput,
          .tried = "write the file",
          .seen = std::strerror(errno),
          .where = InputLocation{path, 0, ""}};
}

bool write_all(int fd, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = write(fd, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return fsync(fd) == 0;
}

}  // namespace

Result<std::string> read_text(const std::string& path) {
  return read_file(path);
}

Result<void> write_text(const std::string& path, const std::string& text) {
  const std::string aside = path + ".part-" + std::to_string(getpid());
  constexpr mode_t kMode = 0644;
  const int fd = open(aside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kMode);
  if (fd < 0) return failure(write_error(path));
  const bool written = write_all(fd, text);
  Error error = write_error(path);
  close(fd);
  if (written && rename(aside.c_str(), path.c_str()) == 0) return {};
  if (written) error = write_error(path);
  unlink(aside.c_str());
  return failure(std::move(error));
}

}  // namespace gonio::cli
