#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "base/clock.h"
#include "base/result.h"
#include "daemon/http/listening_socket.h"
#include "daemon/http/service.h"

namespace gonio::daemon {

struct ServerOptions {
  std::int64_t last_event = 0;                         ///< the newest event of the store
  std::size_t event_client_limit_bytes = 256U << 10U;  ///< of events that wait for one client
  Duration keep_alive = std::chrono::seconds(10);
  Duration most_patience = std::chrono::hours(1);  ///< no answer may take longer, whatever its route allows
};

/// The REST API on a socket (libmicrohttpd): one event thread for each listener, on which nothing lasts longer than a
/// millisecond. At most 512 connections. The destructor answers what is open, then closes.
class Server {
 public:
  /// `service` and `clock` must outlive the server. Errors: Internal (no thread to be had).
  [[nodiscard]] static Result<std::unique_ptr<Server>> start(Listeners listeners, const ServerOptions& options,
                                                             Service& service, const Clock& clock);
  virtual ~Server() = default;

  [[nodiscard]] virtual std::uint16_t port() const = 0;
  /// Tells all event clients. Only what is durable, in the order of its numbers. Threads: any.
  virtual void publish(const api::Event& event) = 0;
};

}  // namespace gonio::daemon
