#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "daemon/planner/step_price.h"

namespace gonio::daemon {

/// The cheapest boustrophedon through the places after the first, starting near the first: all nestings of the axes are
/// walked to and fro and priced, places of equal value on an axis forming one row of it. The places' indices.
[[nodiscard]] std::vector<std::int32_t> best_snake(std::span<const Place> places, const StepPrice& price);

/// The price of walking the places in this order from the first one, in s: half of what it costs forth and back, with
/// the way from the first place once.
[[nodiscard]] double walk_s(std::span<const Place> places, std::span<const std::int32_t> order, const StepPrice& price);

}  // namespace gonio::daemon
