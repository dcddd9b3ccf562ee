#include "daemon/store/store_lock.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace gonio::daemon {

namespace {

std::string holder_of(int fd) {
  std::array<char, 32> text{};
  const ssize_t n = pread(fd, text.data(), text.size() - 1, 0);
  return n > 0 ? std::string(text.data(), static_cast<std::size_t>(n)) : std::string("unknown");
}

Error lock_failed(const std::string& path) {
  return Error{
      .code = ErrorCode::StoreFailed, .device = "store", .tried = "lock " + path, .seen = std::strerror(errno)};
}

}  // namespace

Result<StoreLock> StoreLock::take(const std::string& store_path) {
  const std::string path = store_path + ".lock";
  StoreLock lock(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (lock.fd_ < 0) return failure(lock_failed(path));
  if (flock(lock.fd_, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return failure(lock_failed(path));
    return failure(Error{.code = ErrorCode::StoreLocked,
                         .device = "store",
                         .tried = "open " + store_path,
                         .seen = "in use by process " + holder_of(lock.fd_),
                         .limit = "one daemon a store"});
  }
  const std::string pid = fmt::format("{}", getpid());
  const bool written =
      ftruncate(lock.fd_, 0) == 0 && pwrite(lock.fd_, pid.data(), pid.size(), 0) == static_cast<ssize_t>(pid.size());
  if (!written) return failure(lock_failed(path));
  return lock;
}

StoreLock::StoreLock(StoreLock&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

StoreLock& StoreLock::operator=(StoreLock&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

StoreLock::~StoreLock() {
  if (fd_ >= 0) close(fd_);
}

}  // namespace gonio::daemon
