#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "base/clock.h"

namespace gonio::daemon {

/// A bounded queue into one thread. Threads: any may post and close; one takes.
template <class T>
class Mailbox {
 public:
  explicit Mailbox(std::size_t capacity) : capacity_(capacity) {}

  /// False when it is full or closed; the message is dropped then, and its sender must say so to whoever waits.
  [[nodiscard]] bool post(T message) {
    {
      const std::lock_guard lock(mutex_);
      if (is_closed_ || messages_.size() >= capacity_) return false;
      messages_.push_back(std::move(message));
    }
    arrived_.notify_one();
    return true;
  }

  /// The oldest message; waits for one until `wake` (for ever without one). Nothing: `wake` has passed, or it is
  /// closed.
  [[nodiscard]] std::optional<T> take_until(std::optional<Instant> wake, const Clock& clock) {
    std::unique_lock lock(mutex_);
    while (messages_.empty() && !is_closed_) {
      const Duration left = wake ? *wake - clock.now() : kLongestWait;
      if (left <= Duration::zero()) return std::nullopt;
      arrived_.wait_for(lock, std::min(left, kLongestWait));
    }
    if (is_closed_) return std::nullopt;
    std::optional<T> oldest(std::move(messages_.front()));
    messages_.pop_front();
    return oldest;
  }

  /// What was not taken is dropped, and nothing more comes in.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      is_closed_ = true;
      messages_.clear();
    }
    arrived_.notify_all();
  }

  [[nodiscard]] bool is_closed() const {
    const std::lock_guard lock(mutex_);
    return is_closed_;
  }

 private:
  // The wait's own clock stands while the machine sleeps, ours does not: so it is asked again now and then.
  static constexpr Duration kLongestWait = std::chrono::seconds(1);

  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<T> messages_;
  bool is_closed_ = false;
};

}  // namespace gonio::daemon
