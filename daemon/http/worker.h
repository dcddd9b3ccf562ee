#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace gonio::daemon {

/// One thread that does what must not be done on the event thread, in order, with a bounded queue before it.
/// Threads: post from any. The destructor finishes the job in hand and drops the others.
class Worker {
 public:
  explicit Worker(std::size_t at_most_waiting);
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// False when too much is waiting already: the job is not taken.
  [[nodiscard]] bool post(std::function<void()> job);

 private:
  void run();

  const std::size_t at_most_waiting_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace gonio::daemon
