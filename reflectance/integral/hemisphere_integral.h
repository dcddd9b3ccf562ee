#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "reflectance/direction/direction.h"
#include "reflectance/integral/integral.h"

namespace gonio::reflectance {

/// A direction with its share of the projected solid angle mu dOmega; the weights of a hemisphere sum to pi.
struct HemisphereNode {
  Direction direction;
  double weight_sr = 0.0;
};

/// In what the rings of a Gauss rule are Gaussian.
enum class RingSpacing : std::uint8_t {
  Mu,      ///< exact for polynomials in mu
  SqrtMu,  ///< closer to the horizon: takes the powers of mu by which many BRDFs end there
};

/// `rings` Gauss-Legendre rings from the horizon upwards, each of `azimuths` directions at phi = (j + 1/2) 360 deg /
/// azimuths: with spacing Mu exact for polynomials of degree 2 rings - 2 in mu with harmonics below `azimuths` in phi.
/// Ring by ring, phi fastest. Both at least 1 (asserted).
[[nodiscard]] std::vector<HemisphereNode> gauss_rings(int rings, int azimuths, RingSpacing spacing = RingSpacing::Mu);

/// integral over the upper hemisphere of s(r) mu_r dOmega_r, in the unit of s times sr: pi for s = 1. So the shape
/// table of a standard with an 8/h certificate is normalised by integrate_hemisphere(s at theta_i = 8 deg).value / pi.
/// Gauss rings, doubled until two of them agree to `relative_tolerance` (of the value, or of the integral of |s| where
/// s changes sign) or 256 rings are reached. A kink in s, as in an interpolated table, slows it to some 1e-5. `s` must
/// give finite numbers.
[[nodiscard]] Integral integrate_hemisphere(const std::function<double(const Direction&)>& s,
                                            double relative_tolerance = 1e-6, RingSpacing spacing = RingSpacing::Mu);

}  // namespace gonio::reflectance
