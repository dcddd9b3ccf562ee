#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "cli/http_client.h"
#include "protocol/api/json.h"
#include "protocol/api/route.h"

namespace gonio::cli {

/// A reply with the text it was read from, which `-o json` shows.
template <class T>
struct Told {
  T value;
  std::string text;
};

/// The daemon's routes as calls. Threads: one. Errors of all: those of the daemon, NoDaemon, TimedOut, Stopped,
/// BadReply.
class DaemonClient {
 public:
  DaemonClient(HttpClient http, std::string connect) : http_(std::move(http)), connect_(std::move(connect)) {}

  template <class T>
  [[nodiscard]] Result<Told<T>> get(api::RouteId route, std::int64_t scan = 0, const std::string& query = {}) {
    return read<T>(fetch(route, scan, query));
  }
  template <class T>
  [[nodiscard]] Result<Told<T>> post(api::RouteId route, std::int64_t scan, const std::string& body,
                                     const std::map<std::string, std::string>& headers = {}) {
    return read<T>(send(route, scan, body, headers));
  }
  /// The body as it came.
  [[nodiscard]] Result<std::string> text(api::RouteId route, std::int64_t scan, const std::string& query) {
    return fetch(route, scan, query);
  }
  /// Each event after `after`, until `take` returns false. A stream that ends is begun again where it ended, up to a
  /// bound of failures in a row.
  [[nodiscard]] Result<void> events(std::int64_t after, const std::function<bool(const api::Event&)>& take);

  [[nodiscard]] const std::string& connect() const { return connect_; }

 private:
  [[nodiscard]] Result<std::string> fetch(api::RouteId route, std::int64_t scan, const std::string& query);
  [[nodiscard]] Result<std::string> send(api::RouteId route, std::int64_t scan, const std::string& body,
                                         const std::map<std::string, std::string>& headers);
  template <class T>
  [[nodiscard]] static Result<Told<T>> read(Result<std::string> text) {
    if (!text) return failure(text.error());
    Result<T> value = api::report_from_json<T>(*text);
    if (!value) return failure(value.error());
    return Told<T>{std::move(value).value(), std::move(text).value()};
  }

  HttpClient http_;
  std::string connect_;
};

}  // namespace gonio::cli
