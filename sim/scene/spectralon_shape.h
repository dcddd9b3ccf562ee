#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/geometry.h"
#include "sim/scene/reference_spec.h"

namespace gonio::sim {

/// An angular shape like that of sintered PTFE: what f_ref = rho s / pi is made of. Reciprocal, analytic:
///   s = N [ L(mu_i) L(mu_r) + B exp(-(sin(xi/2) / w)^2) + C (sin theta_i sin theta_r)^6 sin^4(dphi/2) ],  L(mu) = 1 -
///   c (1 - mu)^2
/// a gentle limb darkening, a small rise towards retro-reflection, a strong one forward at grazing angles, with sizes
/// as published for 99 % Spectralon (0/45 factor 1.01-1.02, 60/60 forward about 1.2, 70/70 forward about 1.6). N makes
/// the integral of s mu_r dOmega_r / pi at theta_i = 8 deg equal 1. Value type; threads: any.
class SpectralonShape {
 public:
  SpectralonShape();
  /// Thetas in [0, 90 deg].
  [[nodiscard]] double operator()(const Geometry& g) const;

 private:
  double norm_ = 1.0;
};

/// The factor 1 + sum a_k M_k(G) of one draw; `amplitudes` as long as `modes`.
[[nodiscard]] double mode_factor(const Geometry& g, std::span<const ShapeMode> modes,
                                 std::span<const double> amplitudes);

/// (1/pi) integral of s(8 deg, theta_r, phi_r) mu_r dOmega_r: what an 8/h certificate fixes, for any shape.
[[nodiscard]] double integral_at_8_degrees(const std::function<double(const Geometry&)>& shape);

/// The grid on which the daemon gets the shape, in degrees: theta_i and theta_r the same.
struct ShapeGrid {
  std::vector<double> theta_deg;
  std::vector<double> phi_deg;
};
/// Fine enough for linear interpolation to lie within 4e-3 of the shape, 2e-3 below 60 deg.
[[nodiscard]] ShapeGrid shape_grid();

}  // namespace gonio::sim
