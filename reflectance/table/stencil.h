#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "reflectance/direction/direction.h"
#include "reflectance/table/delaunay.h"

namespace gonio::reflectance {

/// The hemisphere in the plane, seen from the foot of its axis (stereographic): circles stay circles, so that the
/// Delaunay triangles of the plane are those of the sphere, and stay as well shaped as they are there. The horizon is
/// the unit circle.
[[nodiscard]] inline PlanePoint plane_point(const Vector& r) {
  return {.x = r.x / (1.0 + r.z), .y = r.y / (1.0 + r.z)};
}
[[nodiscard]] inline Vector from_plane(const PlanePoint& p) {
  const double rho2 = p.x * p.x + p.y * p.y;
  return {.x = 2.0 * p.x / (1.0 + rho2), .y = 2.0 * p.y / (1.0 + rho2), .z = (1.0 - rho2) / (1.0 + rho2)};
}

/// The angle between two unit vectors [rad], with all digits for close ones.
[[nodiscard]] inline double arc(const Vector& a, const Vector& b) {
  const double chord = std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
  return 2.0 * std::asin(std::min(1.0, 0.5 * chord));
}

/// A value between readings as a weighted sum of them.
struct Stencil {
  std::array<std::uint32_t, 4> node{};
  std::array<double, 4> weight{};  ///< none below 0, sum 1
  std::size_t size = 0;
  double width = 0.0;     ///< of the cell [rad]
  bool is_inside = true;  ///< within the reach of the readings
  Vector place;           ///< the direction itself, or where the reach ends closest to it

  void add(std::size_t k, double w) {
    node[size] = static_cast<std::uint32_t>(k);
    weight[size++] = w;
  }
};

/// What part of a node's value one reading is.
struct ReadingShare {
  std::uint32_t reading = 0;  ///< its index, as TabulatedSurface::make was given them
  double weight = 0.0;
};
/// Of one node: the weights sum to 1.
using Origins = std::vector<ReadingShare>;

/// One reading, or several of the same direction made one, in the frame of its incidence: x points along phi_i.
struct TableNode {
  Vector r;  ///< of unit length
  double f = 0.0;
  double u = 0.0;
};

}  // namespace gonio::reflectance
