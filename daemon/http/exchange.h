#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "protocol/api/route.h"

namespace gonio::daemon {

/// A request as it came, before anything of it is believed. Header names in lower case.
struct HttpRequest {
  std::string method;
  std::string path;
  std::map<std::string, std::string> query;
  std::map<std::string, std::string> headers;
  std::string body;
  std::string who;  ///< "local", or "uid:1000" by the peer's credentials
  bool by_unix_socket = false;

  /// Empty when it is not there.
  [[nodiscard]] std::string header(const std::string& name) const {
    const auto found = headers.find(name);
    return found == headers.end() ? std::string() : found->second;
  }
};

struct HttpResponse {
  int status = 200;
  std::string content_type;
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;
};

/// As problem+json. `status` 0: the one of the error's code.
[[nodiscard]] HttpResponse problem(const Error& error, int status = 0);

/// The place where one answer is waited for. Threads: any; the first answer counts, later ones are dropped.
class Exchange {
 public:
  /// `wake` is called once, by whoever answers, on its thread.
  explicit Exchange(std::function<void()> wake) : wake_(std::move(wake)) {}

  void answer(HttpResponse response);
  [[nodiscard]] bool is_answered() const;
  /// The answer; valid once is_answered.
  [[nodiscard]] const HttpResponse& response() const { return *response_; }

 private:
  mutable std::mutex mutex_;
  std::function<void()> wake_;
  std::optional<HttpResponse> response_;  ///< written once, under the mutex
};

}  // namespace gonio::daemon
