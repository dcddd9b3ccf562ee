#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "daemon/planner/neighbours.h"
#include "daemon/planner/step_price.h"

namespace gonio::daemon {

/// Makes a walk from the first place through all others cheaper (by `price.mean_s`; the end is free), and gives it
/// back. 2-opt (Croes 1958) and Or-opt (Or 1976) moves among neighbours with don't-look bits (Bentley 1992) until none
/// helps; then `kicks` local double bridges (Martin, Otto, Felten 1991), each repaired and kept if the walk is no
/// longer. Deterministic. `walk`: the indices of all places but the first, each once.
[[nodiscard]] std::vector<std::int32_t> shorten(std::span<const Place> places, const StepPrice& price,
                                                const Neighbours& neighbours, std::span<const std::int32_t> walk,
                                                std::int64_t kicks);

/// The nearest place not yet visited, again and again, from the first. When all neighbours are visited, the search
/// goes on from the last place that still has one.
[[nodiscard]] std::vector<std::int32_t> greedy_walk(std::span<const Place> places, const Neighbours& neighbours);

}  // namespace gonio::daemon
