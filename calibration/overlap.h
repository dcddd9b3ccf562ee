#pragma once

#include <cstdint>
#include <optional>

#include "base/geometry.h"
#include "base/units.h"

namespace gonio::calibration {

/// Evenly filled round beams with one axis point on the middle of a round target.
struct BeamDiscs {
  Length spot_radius;                   ///< across the source's beam
  Length field_radius;                  ///< across the detector's
  std::optional<Length> target_radius;  ///< none: endless
};

/// O of q = K f_r mu_i mu_r O: the area of the surface that is lit, seen and on the target, and what it depends on.
struct Overlap {
  double area_mm2 = 0.0;
  double by_spot = 0.0;  ///< d ln O / d ln (spot radius), 0 where the spot has no part in the edge; likewise the others
  double by_field = 0.0;  ///< the three add up to 2
  double by_target = 0.0;
  /// Means over the area of (distance from the beam's axis / its radius)^2: 1/2 of a beam that is all within. d ln O /
  /// dc of a falloff c (overlap_model.h) is 1 - 2 of it.
  double spot_mean_square = 0.0;
  double field_mean_square = 0.0;
};

/// Closed form: the spot is an ellipse stretched by 1 / mu_i along phi_i, the field by 1 / mu_r along phi_r, and seen
/// from their middle the edge is at each azimuth the nearest of the three. 1 / r^2 of each goes as a + b cos 2 phi + c
/// sin 2 phi, so that two of them cross at most twice in half a turn, and a sector of an ellipse is its half axes times
/// the change of its eccentric anomaly. Both thetas below 90 deg (asserted). Relative error some 1e-15 / min(mu_i,
/// mu_r)^2. Threads: any.
[[nodiscard]] Overlap overlap_of(const BeamDiscs& discs, const Geometry& g);

/// Which of the two limits a geometry is in (Mobley 2005, footnote 5, and its reverse).
enum class BeamMode : std::uint8_t {
  Radiance,   ///< the field, grown by the margin, lies within spot and target: q = K' f_r mu_i
  Intensity,  ///< the spot, grown by the margin, lies within field and target: q = K'' f_r mu_r
  Mixed,      ///< neither: q as O says
};
/// `margin`: relative, of the inner ellipse's radius. Not only in the plane of incidence: the ellipses' long axes lie
/// along phi_i and phi_r, wherever these are.
[[nodiscard]] BeamMode beam_mode(const BeamDiscs& discs, const Geometry& g, double margin = 0.02);

}  // namespace gonio::calibration
