#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace gonio::reflectance {

/// A point of the plane into which the hemisphere is projected (see plane_point.h), where it fills the unit disc.
struct PlanePoint {
  double x = 0.0;
  double y = 0.0;
};

/// A triangle of a triangulation, counter-clockwise. `neighbour[k]` lies across the edge opposite to `corner[k]`.
struct MeshTriangle {
  static constexpr std::int32_t kNone = -1;  ///< beyond the hull
  std::array<std::int32_t, 3> corner{};
  std::array<std::int32_t, 3> neighbour{kNone, kNone, kNone};
};

/// The Delaunay triangulation of `points` (Bowyer 1981, Watson 1981), all inside of the square [-1, 1]^2, no two of
/// them closer than 1e-8: every point is a corner, the triangles fill the convex hull and none overlap. The topology is
/// decided in whole numbers (points rounded to 2^-30) and so is exact: cocircular and collinear points, as on any grid,
/// are ordinary. Triangles on the border that are flatter than 1e-6 of their length, which rounding makes of collinear
/// border points, are left out. Errors: InvalidInput when the points lie on one line or are fewer than three.
[[nodiscard]] Result<std::vector<MeshTriangle>> delaunay(std::span<const PlanePoint> points);

}  // namespace gonio::reflectance
