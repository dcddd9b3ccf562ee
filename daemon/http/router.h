#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/api/route.h"

namespace gonio::daemon {

/// What a method and a path lead to.
struct RouteMatch {
  const api::Route* route = nullptr;  ///< null: none
  std::int64_t scan = 0;              ///< the number in the path: of `{scan}`, `{job}`
  std::string allowed;  ///< without a route: the methods that this path has, "GET, POST"; empty: no such path
};

[[nodiscard]] RouteMatch find_route(std::string_view method, std::string_view path);

}  // namespace gonio::daemon
