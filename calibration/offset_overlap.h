#pragma once

#include "base/geometry.h"
#include "base/units.h"
#include "calibration/overlap.h"

namespace gonio::calibration {

/// Where the spot's middle lies on the surface, seen from the middle of field and target.
struct SpotPlace {
  Length x;  ///< towards phi = 0
  Length y;  ///< towards phi = 90 deg
};

struct OffsetOverlap {
  double area_mm2 = 0.0;
  double per_x = 0.0;  ///< d area / d place, mm
  double per_y = 0.0;
};

/// The area common to spot, field and target with the spot off the middle: by Green's theorem along the arcs of the
/// three edges that lie within the two others. Crossings are the zeros of a trigonometric polynomial of second degree
/// in the eccentric anomaly, found by halving intervals until a bound on its slope says that there is none or just one.
/// Relative error some 1e-13. No common area: 0. Both thetas below 90 deg. Threads: any.
[[nodiscard]] OffsetOverlap offset_overlap(const BeamDiscs& discs, const Geometry& g, const SpotPlace& spot);

}  // namespace gonio::calibration
