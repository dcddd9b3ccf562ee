#pragma once

#include <mutex>
#include <optional>
#include <utility>

#include "base/error.h"

namespace gonio::daemon {

/// The last of something that one thread learns and others show: the value last known, and the error if the last try
/// failed. Threads: any.
template <class T>
class Latest {
 public:
  void set(T value) {
    const std::lock_guard lock(mutex_);
    value_ = std::move(value);
    error_.reset();
  }
  void set_error(Error error) {
    const std::lock_guard lock(mutex_);
    error_ = std::move(error);
  }
  [[nodiscard]] std::optional<T> value() const {
    const std::lock_guard lock(mutex_);
    return value_;
  }
  [[nodiscard]] std::optional<Error> error() const {
    const std::lock_guard lock(mutex_);
    return error_;
  }

 private:
  mutable std::mutex mutex_;
  std::optional<T> value_;
  std::optional<Error> error_;
};

}  // namespace gonio::daemon
