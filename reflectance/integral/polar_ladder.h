#pragma once

#include <optional>

#include "reflectance/integral/integral.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// A first try at polar_integral with few evaluations (some 500 to 1e-6): rungs of Gauss nodes along the arc and evenly
/// spread azimuths about `axis`, each rung with 1.4 times as many of both. `settled` where two steps show that it
/// converges; the error is the last difference or a fifth of the one before, whichever is larger, so that two rungs
/// that agree by chance do not count. Left alone: an axis within 15 deg of the horizon, a peak narrower than some 0.1
/// rad.
struct PolarLadder {
  std::optional<Integral> settled;
  std::uint64_t evaluations = 0;
};
[[nodiscard]] PolarLadder climb_polar_ladder(const Surface& surface, const Direction& i, const Direction& axis,
                                             double relative_tolerance);

}  // namespace gonio::reflectance
