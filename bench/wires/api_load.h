#pragma once

#include <atomic>
#include <thread>

namespace gonio::bench {

/// Clients that a daemon has besides: some read its events, the others ask for its status again and again, each
/// twice a second. Threads: one of its own.
class ApiLoad {
 public:
  ApiLoad(int port, int event_clients, int status_clients);
  ApiLoad(const ApiLoad&) = delete;
  ApiLoad& operator=(const ApiLoad&) = delete;
  ~ApiLoad() { thread_.request_stop(); }

  /// Bytes of events and of answers so far: that the clients are served at all.
  [[nodiscard]] long event_bytes() const { return event_bytes_; }
  [[nodiscard]] long answers() const { return answers_; }

 private:
  void run(const std::stop_token& stop, int port, int event_clients, int status_clients);

  std::atomic<long> event_bytes_{0};
  std::atomic<long> answers_{0};
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace gonio::bench
