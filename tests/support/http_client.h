#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace gonio::test {

struct HttpAnswer {
  int status = 0;                              ///< 0: no daemon answered
  std::map<std::string, std::string> headers;  ///< names in lower case
  std::string body;
};

/// One request on a connection of its own, by plain sockets: a client that shares no code with ours.
/// `deadline` bounds the whole exchange.
[[nodiscard]] HttpAnswer http_request(int port, const std::string& method, const std::string& path,
                                      const std::string& body = {},
                                      const std::map<std::string, std::string>& headers = {},
                                      std::chrono::seconds deadline = std::chrono::seconds(30));

struct ServerEvent {
  long number = 0;
  std::string kind;
  std::string data;
};

/// Reads /api/v1/events on a thread of its own until it is destroyed or the daemon goes. Threads: any.
class EventReader {
 public:
  /// Events after number `after`.
  EventReader(int port, long after);
  ~EventReader();
  EventReader(const EventReader&) = delete;
  EventReader& operator=(const EventReader&) = delete;

  [[nodiscard]] std::vector<ServerEvent> events() const;
  [[nodiscard]] long last_number() const;
  [[nodiscard]] bool is_connected() const { return connected_; }
  /// Waits until `condition(events)` holds; false at the deadline or when the connection has ended without it.
  bool wait_for(const std::function<bool(const std::vector<ServerEvent>&)>& condition,
                std::chrono::milliseconds deadline);

 private:
  void read(int port, long after);
  void take(const std::string& block);

  int fd_ = -1;
  std::atomic<bool> stop_{false};
  std::atomic<bool> connected_{false};
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<ServerEvent> events_;
  bool ended_ = false;
  std::thread thread_;
};

}  // namespace gonio::test
