#pragma once

#include <cstdint>
#include <vector>

#include "base/geometry.h"
#include "base/units.h"

namespace gonio::reflectance {

/// What one standard deviation of a shared component of uncertainty does to a value: signed, and absolute, for the
/// value may be 0. The components are independent of each other; what the numbers stand for is the caller's.
struct SharedEffect {
  std::uint32_t component = 0;
  Brdf per_sd;
};

/// A measured BRDF with what is known of its error, as data.
struct SymmetryPoint {
  Geometry geometry;
  Brdf value;
  Brdf u_random;                     ///< k = 1, of what this point shares with no other; above 0
  std::vector<SharedEffect> shared;  ///< in any order; those of one component are added
};

}  // namespace gonio::reflectance
