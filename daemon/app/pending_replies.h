#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

namespace gonio::daemon {

/// Answers that are waited for, by number. Threads: any.
template <class T>
class PendingReplies {
 public:
  using Callback = std::function<void(T)>;

  void add(std::uint64_t id, Callback callback) {
    const std::lock_guard lock(mutex_);
    waiting_.emplace(id, std::move(callback));
  }

  /// Calls those with this number, once each, outside of the lock.
  void answer(std::uint64_t id, const T& value) {
    for (const Callback& callback : take(id, id)) callback(value);
  }
  /// Calls those with this number or a smaller one.
  void answer_up_to(std::uint64_t id, const T& value) {
    for (const Callback& callback : take(0, id)) callback(value);
  }

 private:
  std::vector<Callback> take(std::uint64_t first, std::uint64_t last) {
    const std::lock_guard lock(mutex_);
    std::vector<Callback> found;
    const auto begin = waiting_.lower_bound(first);
    const auto end = waiting_.upper_bound(last);
    for (auto it = begin; it != end; ++it) found.push_back(std::move(it->second));
    waiting_.erase(begin, end);
    return found;
  }

  std::mutex mutex_;
  std::multimap<std::uint64_t, Callback> waiting_;
};

}  // namespace gonio::daemon
