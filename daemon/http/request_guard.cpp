#include "daemon/http/request_guard.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

namespace gonio::daemon {
namespace {

constexpr std::array<std::string_view, 3> kLoopbackNames{"localhost", "127.0.0.1", "[::1]"};

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// "application/json" of "Application/JSON; charset=utf-8".
std::string media_type(const std::string& content_type) {
  std::string type = lower(content_type.substr(0, content_type.find(';')));
  while (!type.empty() && type.back() == ' ') type.pop_back();
  return type;
}

Error refusal(ErrorCode code, std::string seen, std::string limit) {
  return {.code = code,
          .device = "http",
          .tried = "answer the request",
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

Result<void> check_body(const HttpRequest& request, const api::Route& route) {
  if (!route.takes.empty() && media_type(request.header("content-type")) != route.takes) {
    const std::string declared = request.header("content-type");
    return failure(refusal(ErrorCode::UnsupportedMediaType,
                           declared.empty() ? "no Content-Type is declared" : "Content-Type \"" + declared + "\"",
                           "Content-Type: " + std::string(route.takes)));
  }
  const std::string declared = request.header("content-length");
  std::size_t length = 0;
  (void)std::from_chars(declared.data(), declared.data() + declared.size(), length);
  if (length > route.body_limit) {
    return failure(
        refusal(ErrorCode::TooLarge, "a body of " + declared + " bytes", std::to_string(route.body_limit) + " bytes"));
  }
  return {};
}

}  // namespace

RequestGuard::RequestGuard(std::uint16_t port) {
  for (const std::string_view name : kLoopbackNames) names_.push_back(std::string(name) + ":" + std::to_string(port));
}

bool RequestGuard::is_our_name(const std::string& host, bool by_unix_socket) const {
  const std::string name = lower(host);
  if (std::ranges::find(names_, name) != names_.end()) return true;
  return by_unix_socket && std::ranges::find(kLoopbackNames, name) != kLoopbackNames.end();
}

Result<void> RequestGuard::check(const HttpRequest& request, const api::Route& route, api::Permission granted) const {
  const std::string host = request.header("host");
  if (!is_our_name(host, request.by_unix_socket)) {
    return failure(refusal(ErrorCode::ForbiddenOrigin, "Host \"" + host + "\"", joined(names_)));
  }
  const std::string origin = request.header("origin");
  constexpr std::string_view kScheme = "http://";
  if (!origin.empty() &&
      (!origin.starts_with(kScheme) || !is_our_name(origin.substr(kScheme.size()), request.by_unix_socket))) {
    return failure(refusal(ErrorCode::ForbiddenOrigin, "Origin \"" + origin + "\"", "pages served by this daemon"));
  }
  if (granted < route.permission) {
    return failure(refusal(ErrorCode::NotAuthorised, "you may look only", "the role operator"));
  }
  return check_body(request, route);
}

}  // namespace gonio::daemon
