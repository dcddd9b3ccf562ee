#pragma once

#include <cstdint>
#include <span>

#include "reflectance/direction/direction_pair.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// How many doubles lie between a and b, one of them included: 0 for the same value (0 and -0 too), 1 for neighbours;
/// the largest number for NaN.
[[nodiscard]] std::uint64_t ulp_distance(double a, double b);

/// Where a surface is least reciprocal.
struct ReciprocityGap {
  std::uint64_t ulps = 0;  ///< between `forth` and `back`; 0: the same bits for all pairs
  DirectionPair pair;
  double forth = 0.0;  ///< f(i, r), or the mirror part's share for i
  double back = 0.0;   ///< f(r, i), or that for the mirror direction of i
  bool is_specular = false;
  std::size_t compared = 0;  ///< pairs
};

/// The largest difference between f(i, r) and f(r, i) over the pairs (Mobley 2005 eq 4), and between the mirror part's
/// shares for i and for its mirror direction. The models of this room give 0. Threads: any.
[[nodiscard]] ReciprocityGap worst_reciprocity_gap(const Surface& surface, std::span<const DirectionPair> pairs);

}  // namespace gonio::reflectance
