#pragma once

#include <cstdint>

#include "base/geometry.h"
#include "reflectance/direction/direction_pair.h"

namespace gonio::formats {

/// One value of a file, in the units that files have. Plain degrees, not `Angle`: to radians and back is not the
/// identity in the last bit, and a file that was read and is written again shall be the same file. Directions as in
/// base/geometry.h: both away from the surface, phi counter-clockwise, retro-reflection at phi_r = phi_i. A negative
/// theta is an arm beyond the normal.
struct BrdfPoint {
  double theta_i_deg = 0.0;
  double phi_i_deg = 0.0;
  double theta_r_deg = 0.0;
  double phi_r_deg = 0.0;
  double f_per_sr = 0.0;         ///< signed: net of dark, so a black sample reads below zero now and then
  double U_per_sr = 0.0;         ///< expanded uncertainty, k u; 0 where none is known
  double k = 0.0;                ///< its coverage factor; 0 where the file does not say
  double u_shared_per_sr = 0.0;  ///< the standard uncertainty's part that all points share; 0 where not told apart
  std::uint32_t channel = 0;     ///< index into MeasuredBrdf::channels
  std::uint32_t flags = 0;       ///< bit n: MeasuredBrdf::flag_names[n]
  friend bool operator==(const BrdfPoint&, const BrdfPoint&) = default;
};

[[nodiscard]] Geometry geometry_of(const BrdfPoint& point);
/// A negative theta is turned to the direction that it points at. Thetas in [-90, 90] deg (asserted).
[[nodiscard]] reflectance::DirectionPair directions_of(const BrdfPoint& point);

/// The same directions with theta in [0, 90] and phi in [0, 360) deg, as most files want them. A point that is in these
/// ranges already keeps its bits.
[[nodiscard]] BrdfPoint in_plain_ranges(const BrdfPoint& point);
/// phi in [0, 360).
[[nodiscard]] double plain_azimuth_deg(double phi_deg);

/// The standard uncertainty U/k [sr^-1]; k = 1 is taken where none is told.
[[nodiscard]] double standard_u_per_sr(const BrdfPoint& point);

}  // namespace gonio::formats
