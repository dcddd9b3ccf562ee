#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "base/result.h"
#include "daemon/http/event_client.h"
#include "daemon/http/worker.h"
#include "protocol/api/reports.h"

namespace gonio::daemon {

/// Hands committed events to every client that listens, each once and in order, from any number on: what a client has
/// not had is fetched from the store, then it goes live. A client that does not read is bounded, then dropped; it may
/// come back with Last-Event-ID and loses nothing. Threads: any.
class EventHub {
 public:
  /// Committed events with number > `after`; called on the hub's own thread.
  using Fetch = std::function<Result<std::vector<api::Event>>(std::int64_t after, int at_most)>;

  /// `last`: the newest event of the store, before anything is published.
  EventHub(Fetch fetch, std::int64_t last, std::size_t client_limit_bytes);

  /// Only what is durable, in the order of its numbers.
  void publish(const api::Event& event);
  /// Listens from `after` on, or to what comes from now. Call `catch_up` when its `read` says that it needs more.
  [[nodiscard]] std::shared_ptr<EventClient> listen(std::optional<std::int64_t> after, ConnectionHooks hooks);
  void catch_up(const std::shared_ptr<EventClient>& client);
  /// Call every 10 s or so.
  void keep_alive();
  /// Ends all clients, and those to come: before the server stops.
  void close();

  [[nodiscard]] std::size_t clients() const;
  [[nodiscard]] std::int64_t published() const { return published_; }
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }  ///< too slow

 private:
  void fetch_for(const std::shared_ptr<EventClient>& client);
  void forget_closed();

  const Fetch fetch_;
  const std::size_t client_limit_bytes_;
  mutable std::mutex mutex_;  ///< before any client's
  std::int64_t last_;
  bool closed_ = false;
  std::vector<std::shared_ptr<EventClient>> clients_;
  std::atomic<std::int64_t> published_{0};
  std::atomic<std::int64_t> dropped_{0};
  Worker worker_;  ///< last: its thread ends before what it works on
};

}  // namespace gonio::daemon
