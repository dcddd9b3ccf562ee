#pragma once

#include <span>

#include "base/units.h"

namespace gonio::sim {

/// An ellipse in the plane of the surface, in mm: what a round beam across its axis becomes on it.
struct SurfaceEllipse {
  double centre_x_mm = 0.0;
  double centre_y_mm = 0.0;
  double long_mm = 1.0;   ///< half axis along `azimuth`
  double short_mm = 1.0;  ///< half axis across it
  Angle azimuth;
};

/// A beam of this radius that meets the surface at theta < 90 deg from the azimuth phi: long axis radius / cos(theta).
[[nodiscard]] SurfaceEllipse footprint(Length radius, Angle theta, Angle phi);

/// The area that lies inside of all ellipses (at least one), mm^2. Exact by Green's theorem along the arcs between
/// crossings, which are found to 1e-14 of a turn; two crossings of an ellipse with another closer together than 1/512
/// turn may be missed, which costs less than 1e-6 of its area.
[[nodiscard]] double common_area_mm2(std::span<const SurfaceEllipse> ellipses);

}  // namespace gonio::sim
