#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

#include "base/clock.h"
#include "daemon/http/event_hub.h"
#include "daemon/http/exchange.h"
#include "daemon/http/request_guard.h"
#include "daemon/http/router.h"
#include "daemon/http/service.h"
#include "daemon/http/worker.h"

namespace gonio::daemon {

/// From requests to the service and back, free of the HTTP library. Threads: any.
class Gateway {
 public:
  /// All must outlive the gateway. `port` is the listener's: Host must name it.
  Gateway(Service& service, const EventHub& hub, std::uint16_t port);

  /// By the head alone: the answer to a request that goes no further (404, 405, 403, 415, 413), or nothing.
  [[nodiscard]] std::optional<HttpResponse> refusal(const HttpRequest& request, const RouteMatch& match) const;
  /// Starts what the request asks for and returns at once; the answer goes to `exchange`. STOP is passed on right here,
  /// everything else by a worker. Not for Events.
  void answer(HttpRequest request, const RouteMatch& match, const std::shared_ptr<Exchange>& exchange);
  /// How long the answer may take: motion by hand takes its time.
  [[nodiscard]] static Duration patience(api::RouteId route);
  void count(const HttpResponse& response);

 private:
  void run(const HttpRequest& request, const RouteMatch& match, const std::shared_ptr<Exchange>& exchange);
  void run_command(const HttpRequest& request, const RouteMatch& match, const std::shared_ptr<Exchange>& exchange);
  [[nodiscard]] HttpResponse read(const HttpRequest& request, const RouteMatch& match);
  [[nodiscard]] std::string metrics() const;

  Service& service_;
  const EventHub& hub_;
  const RequestGuard guard_;
  std::array<std::atomic<std::int64_t>, 6> answers_{};  ///< by the first digit of the status
  Worker quick_;                                        ///< status, lists, commands
  Worker slow_;  ///< plans, results, exports: long ones must not delay the others
};

}  // namespace gonio::daemon
