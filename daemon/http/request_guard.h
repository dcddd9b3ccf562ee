#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "daemon/http/exchange.h"

namespace gonio::daemon {

/// The names by which this daemon may be called: what a browser's page of another origin cannot bring about (DNS
/// rebinding shows in Host, a foreign page in Origin).
class RequestGuard {
 public:
  /// For a listener on loopback at `port`.
  explicit RequestGuard(std::uint16_t port);

  /// Looks at the head of a request for `route`: Host, Origin, Content-Type, the declared length, permission.
  /// Errors: ForbiddenOrigin, UnsupportedMediaType, TooLarge, NotAuthorised.
  [[nodiscard]] Result<void> check(const HttpRequest& request, const api::Route& route, api::Permission granted) const;

 private:
  [[nodiscard]] bool is_our_name(const std::string& host, bool by_unix_socket) const;
  std::vector<std::string> names_;
};

}  // namespace gonio::daemon
