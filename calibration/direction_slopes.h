#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "base/geometry.h"
#include "base/large_array.h"
#include "base/units.h"

namespace gonio::calibration {

/// The angles whose zeros may be wrong, in the order of every array below.
enum class DirectionAxis : std::size_t { ThetaI, ThetaR, PhiR };
inline constexpr std::size_t kDirectionAxes = 3;

/// A measured value at its directions.
struct SlopePoint {
  Geometry planned;   ///< says which points lie on one line
  Geometry reported;  ///< says how far apart; finite
  Wavelength wavelength;
  Brdf value;
  Brdf u_random;
  std::int32_t state = 0;  ///< of polarisation: points of one line have the same
};

/// The change of f_r with each angle at one point: sr^-1 per radian, and per radian squared.
struct DirectionSlopes {
  std::array<double, kDirectionAxes> slope{};
  std::array<double, kDirectionAxes> unresolved{};  ///< standard uncertainty of `slope`: what the points do not resolve
  std::array<double, kDirectionAxes> curvature{};   ///< second derivatives along each angle alone
  std::array<double, kDirectionAxes> unresolved_curvature{};  ///< standard uncertainty, likewise
  std::array<double, kDirectionAxes> curvature_noise{};       ///< from the points' u_random
  std::array<bool, kDirectionAxes>
      has_neighbours{};  ///< false: no other point on this line; `slope` is 0, `unresolved` a guess
  /// Whether any points say how f bends with phi; false: `curvature` of phi is 0 and counts for nothing.
  bool has_bend_along_phi = false;
  /// Within 10 deg of the pole of theta_i or theta_r, else 0: the size of the slope across the plane of phi, along
  /// which `slope` goes.
  std::array<double, 2> across_pole{};
};

/// ln f of a value that stands clear of zero, to be differentiated in its place; and where it stands.
struct SlopeOrdinate {
  double log_f = 0.0;
  double u_log = -1.0;    ///< negative: the value has no logarithm
  double cos_dphi = 1.0;  ///< of the reported directions
  [[nodiscard]] bool has_logarithm() const { return u_log >= 0.0; }
};

struct DirectionKey;
class DirectionLines;
class NearbySecants;

/// Slopes from the measured points alone; no model of the surface. For each point and axis:
/// - its line holds the points of the same wavelength and polarisation whose other angles are planned equal (to 0.001
///   deg). A theta line runs through the normal into the opposite half plane; for an isotropic sample a point also
///   stands for its mirror image in the plane of incidence, and theta = 0 belongs to all lines through it;
/// - polynomials of ln f (lobes and canopies are products; of f where a value does not stand 5 u clear of zero) through
///   the point and its 1, 2, 3, 4 nearest neighbours within 45 deg give derivatives s_1 .. s_4, s_0 = 0. What order p
///   misses is taken as the larger of |s_p - s_(p-1)| and |s_(p+1) - s_p|: an estimate for a smooth surface, no bound;
/// - taken is the p with the least noise^2 + missed^2, `unresolved` is what it misses. The noise itself is part of s_p,
///   so the expectation of s_p^2 holds it already;
/// - second derivatives likewise from p = 2 on, of ln f as f (g'' + g'^2). Three points alone say nothing of what they
///   miss: (x_1 + x_2) / 3 g''' + (x_1^2 + x_1 x_2 + x_2^2) / 12 g'''' of their places x_1, x_2 from the point. Both
///   are taken as large as along the theta that has five points, along phi as for a function of sin(theta) cos(dphi);
///   where no line has five points, half of the derivative stands for it;
/// - phi lines of an isotropic sample are even about 0 and 180 deg; at either pole phi has no slope. Where two other
///   points stand within reach, images aside, the first derivative is that of a polynomial in cos(dphi), times
///   -sin(dphi): an isotropic f_r is a function of cos(dphi), and what depends on the phase angle or on the tilt of a
///   facet is so through a sum linear in it (cos xi = mu_i mu_r + sin sin cos(dphi); 1 / cos^2 of the tilt likewise);
/// - without a neighbour: |df/dtheta_i| is taken as large as |df/dtheta_r| and the other way round (equal for what
///   depends on the phase angle or on the tilt of a facet), phi as large as the larger of them times the smaller of
///   sin(theta_i) and sin(theta_r) (at either pole phi means nothing), and without a neighbour along either theta
///   both as large as the steepest secant to the nearest points of the same incidence (nearby_secants.h), |f| per
///   radian at least; second derivatives of the thetas likewise, but for the secants;
/// - across the pole f changes towards the other direction alone, of an isotropic sample: the steepest slope times
///   |sin(dphi)|; of any other, the steepest slope.
/// Newton's divided differences (Abramowitz and Stegun 1964, 25.2.26): each neighbour adds one term.
/// Made in O(n log n); a point is read in O(1), from what lies about it in memory too. Immutable; threads: any.
class SlopeField {
 public:
  /// `points` must outlive it. Made on up to `threads` threads (0: as the machine has); the same bits for any number.
  SlopeField(std::span<const SlopePoint> points, bool isotropic, int threads = 1);
  ~SlopeField();
  SlopeField(const SlopeField&) = delete;
  SlopeField& operator=(const SlopeField&) = delete;

  /// Of points[n].
  [[nodiscard]] DirectionSlopes at(std::size_t n) const;

 private:
  std::span<const SlopePoint> points_;
  bool isotropic_;
  LargeArray<DirectionKey> keys_;
  LargeArray<SlopeOrdinate> ordinates_;
  std::array<std::unique_ptr<const DirectionLines>, kDirectionAxes> lines_;
  std::unique_ptr<const NearbySecants> nearby_;
};

}  // namespace gonio::calibration
