#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reflectance/direction/direction_pair.h"

namespace gonio::reflectance {

/// `count` pairs of directions, the same for the same seed, to try a surface on: half of them anywhere; the others with
/// i near the pole or the horizon, or r near retro-reflection, near the mirror direction or opposite along the horizon,
/// at distances from 1 down to 1e-14 rad and at none.
[[nodiscard]] std::vector<DirectionPair> hard_pairs(std::size_t count, std::uint64_t seed);

}  // namespace gonio::reflectance
