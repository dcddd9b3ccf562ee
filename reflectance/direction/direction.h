#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/geometry.h"
#include "base/result.h"
#include "base/units.h"

namespace gonio::reflectance {

/// A vector in the frame of the sample: z along its normal, x along phi = 0, y along phi = 90 deg. Any length.
struct Vector {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  friend constexpr bool operator==(const Vector&, const Vector&) = default;
};

/// One direction of the upper hemisphere, pointing away from the surface, as in base/geometry.h.
///
/// Carries mu = cos(theta), sin(theta), theta and the elevation 90 deg - theta side by side, each to the full relative
/// precision that its maker had: mu derived from theta loses all digits at the horizon, sin(theta) derived from mu
/// loses them at the pole, and a difference of two directions derived from either loses them at retro-reflection. phi
/// lies in (-180, 180] deg and is 0 at the pole. A plain value, 40 bytes; threads: any.
class Direction {
 public:
  /// The surface's normal.
  constexpr Direction() = default;

  /// `theta` in [0, 90 deg], `phi` any finite angle. Errors: InvalidInput, naming the angle.
  [[nodiscard]] static Result<Direction> make(Angle theta, Angle phi);
  /// `elevation` = 90 deg - theta in [0, 90 deg]: keeps the digits of a direction close to the horizon. Errors:
  /// InvalidInput.
  [[nodiscard]] static Result<Direction> make_from_elevation(Angle elevation, Angle phi);
  /// `v` finite, not zero, z >= 0; it need not have unit length. Errors: InvalidInput.
  [[nodiscard]] static Result<Direction> make_from_vector(const Vector& v);

  /// As the three above for callers that have established the ranges (nodes of a quadrature, a checked plan): a value
  /// outside of them is a bug, asserted.
  [[nodiscard]] static Direction from_angles(Angle theta, Angle phi);
  [[nodiscard]] static Direction from_elevation(Angle elevation, Angle phi);
  [[nodiscard]] static Direction from_vector(const Vector& v);
  /// From mu and sin(theta) both, which the caller keeps consistent: mu^2 + sin^2(theta) = 1.
  [[nodiscard]] static Direction from_cosine(double mu, double sin_theta, Angle phi);

  [[nodiscard]] constexpr double mu() const { return mu_; }
  [[nodiscard]] constexpr double sin_theta() const { return sin_theta_; }
  [[nodiscard]] constexpr Angle theta() const { return theta_; }
  [[nodiscard]] constexpr Angle elevation() const { return elevation_; }
  [[nodiscard]] constexpr Angle phi() const { return phi_; }
  /// Of unit length.
  [[nodiscard]] Vector vector() const;

  friend constexpr bool operator==(const Direction&, const Direction&) = default;
  friend Direction mirrored(const Direction& i);
  friend struct DirectionBlock;  // batch/direction_block.h: the same parts, side by side

 private:
  Direction(double mu, double sin_theta, double theta, double elevation, Angle phi);

  double mu_ = 1.0;
  double sin_theta_ = 0.0;
  Angle theta_{};
  Angle elevation_ = radians(0.5 * std::numbers::pi);
  Angle phi_{};
};

/// The two directions of a reading. An arm that swings through the normal reads a negative theta there: it is taken for
/// what it points at, (-theta, phi + 180 deg). Thetas in [-90, 90 deg] (asserted).
[[nodiscard]] Direction incident_direction(const Geometry& g);
[[nodiscard]] Direction reflected_direction(const Geometry& g);
[[nodiscard]] Geometry geometry_of(const Direction& i, const Direction& r);

/// Where a flat mirror sends light that comes from `i`: the same theta, phi turned by 180 deg.
[[nodiscard]] Direction mirrored(const Direction& i);

/// phi_r - phi_i in (-180, 180] deg: 0 towards retro-reflection, 180 deg towards specular (many radiative transfer
/// codes have it the other way round).
[[nodiscard]] Angle azimuth_difference(const Direction& i, const Direction& r);

/// (theta_i - theta_r) / 2 [rad], from whichever of theta and elevation holds the digits of the difference.
[[nodiscard]] inline double half_theta_difference(const Direction& i, const Direction& r) {
  constexpr Angle kHalfWay = radians(0.25 * std::numbers::pi);
  const bool both_low = i.elevation() < kHalfWay && r.elevation() < kHalfWay;
  return both_low ? 0.5 * (r.elevation().si() - i.elevation().si()) : 0.5 * (i.theta().si() - r.theta().si());
}

/// The parts of which the phase angle and its kin are made, all positive sums, so that none of them cancels:
///   tilt2 = sin^2((theta_i - theta_r)/2),  turn2 = sin^2((phi_i - phi_r)/2),  sines = sin(theta_i) sin(theta_r).
/// The same bits for (i, r) and (r, i).
struct SeparationTerms {
  double tilt2;
  double turn2;
  double sines;
};

[[nodiscard]] inline SeparationTerms separation_terms(const Direction& i, const Direction& r) {
  const double tilt = std::sin(half_theta_difference(i, r));
  const double turn = std::sin(0.5 * (i.phi().si() - r.phi().si()));
  return {.tilt2 = tilt * tilt, .turn2 = turn * turn, .sines = i.sin_theta() * r.sin_theta()};
}

/// sin^2(xi/2) of the phase angle xi between i and r: all digits kept near retro, where 1 - cos(xi) has none.
[[nodiscard]] inline double sin2_half_phase(const SeparationTerms& t) {
  return std::min(1.0, t.tilt2 + t.sines * t.turn2);
}
[[nodiscard]] inline double sin2_half_phase(const Direction& i, const Direction& r) {
  return sin2_half_phase(separation_terms(i, r));
}

/// The parts of the sum of two directions, for what lies about their half vector:
///   rise2 = cos^2((theta_i + theta_r)/2),  facing2 = cos^2((phi_i - phi_r)/2),  sines = sin(theta_i) sin(theta_r).
/// The same bits for (i, r) and (r, i).
struct SumTerms {
  double rise2;
  double facing2;
  double sines;
};

[[nodiscard]] inline SumTerms sum_terms(const Direction& i, const Direction& r) {
  const double rise = std::sin(0.5 * (i.elevation().si() + r.elevation().si()));
  const double facing = std::cos(0.5 * (i.phi().si() - r.phi().si()));
  return {.rise2 = rise * rise, .facing2 = facing * facing, .sines = i.sin_theta() * r.sin_theta()};
}

/// cos^2(xi/2): all digits kept where r is opposite to i along the horizon.
[[nodiscard]] inline double cos2_half_phase(const Direction& i, const Direction& r) {
  const SumTerms t = sum_terms(i, r);
  return std::min(1.0, t.rise2 + t.sines * t.facing2);
}

/// xi in [0, 180 deg]: xi = 2 atan2(sin(xi/2), cos(xi/2)).
[[nodiscard]] Angle phase_angle(const Direction& i, const Direction& r);
/// cos(xi), Mobley (2005) eq 1.
[[nodiscard]] double cos_phase(const Direction& i, const Direction& r);

/// G of Rahman, Pinty and Verstraete (1993), Mobley (2005) eq 8: the distance of the two directions where they pierce
/// the plane z = 1, sqrt(tan^2 ti + tan^2 tr - 2 tan ti tan tr cos(phi_i - phi_r)), from
///   G mu_i mu_r = sqrt(sin^2(ti - tr) + 4 mu_i mu_r sin ti sin tr sin^2((phi_i - phi_r)/2)).
/// `mu_product` = mu_i mu_r, not 0: a model that keeps clear of the horizon gives its own.
[[nodiscard]] inline double retro_distance(const SeparationTerms& t, double mu_product) {
  const double sin2_tilt = 4.0 * t.tilt2 * (1.0 - t.tilt2);
  return std::sqrt(sin2_tilt + 4.0 * mu_product * t.sines * t.turn2) / mu_product;
}
/// As above, for two directions off the horizon (mu = 0 exactly gives infinity or, for two of them, NaN).
[[nodiscard]] double retro_distance(const Direction& i, const Direction& r);

}  // namespace gonio::reflectance
