#pragma once

#include <span>

#include "base/geometry.h"
#include "drivers/stage_config.h"

namespace gonio::bench {

/// A bound below the time of every walk from home through these directions on a stage of arms: motion from rest to rest
/// and settling of each step. Written from the trapezoid's formulas, with none of the planner's code. Directions at
/// which the axes stand alike count once.
///
/// Up to `kMostExact` places: the bound of Held and Karp (1970, 1971), a least spanning tree under multipliers that are
/// raised by subgradients so that it looks like a path. Beyond: half the sum of the two cheapest steps at each place.
struct WalkBound {
  double time_s = 0.0;
  std::size_t places = 0;
  bool is_held_karp = false;
};
inline constexpr std::size_t kMostExact = 1200;
[[nodiscard]] WalkBound lower_bound(const drivers::StageConfig& stage, std::span<const Geometry> directions);

}  // namespace gonio::bench
