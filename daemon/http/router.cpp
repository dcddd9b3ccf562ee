#include "daemon/http/router.h"

#include <charconv>

namespace gonio::daemon {
namespace {

std::optional<std::int64_t> positive_number(std::string_view text) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number <= 0) return std::nullopt;
  return number;
}

// The number in the place of the template's name in braces, 0 for a template without one, or nothing when the path is
// another.
std::optional<std::int64_t> matched(std::string_view path_template, std::string_view path) {
  const std::size_t hole = path_template.find('{');
  if (hole == std::string_view::npos) return path == path_template ? std::optional<std::int64_t>(0) : std::nullopt;
  const std::string_view tail = path_template.substr(path_template.find('}') + 1);
  if (path.size() <= hole + tail.size() || !path.ends_with(tail)) return std::nullopt;
  if (path.substr(0, hole) != path_template.substr(0, hole)) return std::nullopt;
  return positive_number(path.substr(hole, path.size() - hole - tail.size()));
}

}  // namespace

RouteMatch find_route(std::string_view method, std::string_view path) {
  RouteMatch match;
  for (const api::Route& route : api::kRoutes) {
    const std::optional<std::int64_t> scan = matched(route.path, path);
    if (!scan) continue;
    if (api::method_name(route.method) == method) return {.route = &route, .scan = *scan, .allowed = {}};
    match.allowed += (match.allowed.empty() ? "" : ", ") + std::string(api::method_name(route.method));
  }
  return match;
}

}  // namespace gonio::daemon
