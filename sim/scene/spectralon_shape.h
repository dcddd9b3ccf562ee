#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/geometry.h"
#include "sim/scene/reference_spec.h"

namespace gonio::sim {

/// An angular shape like that of sintered PTFE: what f_ref = rho s / pi is made of. Two lobes that scatter once,
/// towards retro-reflection and forward at grazing angles, and a body that sends back all that they leave:
///   F = B exp(-(sin(xi/2) / w)^2) + C (sin theta_i sin theta_r)^6 sin^4(dphi/2)
///   s = N [ F + (1 - E(mu_i)) (1 - E(mu_r)) / (1 - E_mean) ],  E(mu) = (1/pi) int F mu_r dOmega_r,
///   E_mean = 2 int E mu dmu
/// (the coupling of Kelemen and Szirmay-Kalos 2001): reciprocal, and (1/pi) int s mu_r dOmega_r is 1 at every theta_i
/// to 1e-5, so that no light comes back that was not sent. Sizes as published for 99 % Spectralon (0/45 factor
/// 1.01-1.02, 60/60 forward about 1.2, 70/70 forward about 1.6). N makes that integral at theta_i = 8 deg equal 1.
/// Value type; threads: any.
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
