#pragma once

#include <string>

#include "base/result.h"

namespace gonio::daemon {

/// Keeps a second writer out: an exclusive lock on a file beside the store, held until destruction or the process' end,
/// however it ends. Lost: SQLite's own exclusive mode, which would keep the readers out too.
class StoreLock {
 public:
  /// Errors: StoreLocked (with the pid of the holder), StoreFailed.
  [[nodiscard]] static Result<StoreLock> take(const std::string& store_path);
  StoreLock(StoreLock&& other) noexcept;
  StoreLock& operator=(StoreLock&& other) noexcept;
  ~StoreLock();

 private:
  explicit StoreLock(int fd) : fd_(fd) {}
  int fd_ = -1;
};

}  // namespace gonio::daemon
