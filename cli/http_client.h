#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "base/result.h"

namespace gonio::cli {

struct HttpReply {
  int status = 0;
  std::string body;
};

/// HTTP to one daemon, by TCP or by a unix socket (libcurl). Threads: one.
class HttpClient {
 public:
  /// `connect`: "http://127.0.0.1:8470" or "unix:/run/goniod/socket". `interrupted` becoming true ends any call with
  /// Stopped. Errors: InvalidInput.
  [[nodiscard]] static Result<HttpClient> open(const std::string& connect, const std::atomic<bool>& interrupted);
  HttpClient(HttpClient&&) noexcept;
  HttpClient& operator=(HttpClient&&) noexcept;
  ~HttpClient();

  /// Errors of all: NoDaemon, TimedOut, Stopped (interrupted). `patience` bounds the whole exchange; zero: no bound but
  /// the connection's own. Any status is a reply.
  [[nodiscard]] Result<HttpReply> get(const std::string& path, std::chrono::seconds patience);
  [[nodiscard]] Result<HttpReply> post(const std::string& path, const std::string& json_body,
                                       const std::map<std::string, std::string>& headers,
                                       std::chrono::seconds patience);
  /// Gives what comes to `take` until it returns false (success), or the stream ends (NoDaemon).
  [[nodiscard]] Result<HttpReply> stream(const std::string& path, const std::map<std::string, std::string>& headers,
                                         const std::function<bool(std::string_view)>& take);

 private:
  struct Impl;
  explicit HttpClient(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace gonio::cli
