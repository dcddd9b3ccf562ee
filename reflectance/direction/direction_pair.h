#pragma once

#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// Where the light comes from and where it is seen, both pointing away from the surface.
struct DirectionPair {
  Direction i;
  Direction r;
  friend constexpr bool operator==(const DirectionPair&, const DirectionPair&) = default;
};

}  // namespace gonio::reflectance
