#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "reflectance/direction.h"

namespace gonio::reflectance {

/// A computed integral. `error` estimates |value - truth| from the last refinement, rounding included: it is meant to be
/// an upper bound, and stands above the asked tolerance when the work's bound was reached first.
struct Integral {
  double value = 0.0;
  double error = 0.0;
  std::uint64_t evaluations = 0;  ///< of the integrand; 0 for a closed form
};

/// A direction with its share of the projected solid angle mu dOmega; the weights of a hemisphere sum to pi.
struct HemisphereNode {
  Direction direction;
  double weight_sr = 0.0;
};

/// `rings` Gauss-Legendre nodes in mu, each a ring of `azimuths` directions at equal steps of phi, from the horizon's ring
/// upwards: exact for polynomials of degree 2 rings - 2 in mu with harmonics below `azimuths` in phi.
/// Both at least 1 (asserted).
[[nodiscard]] std::vector<HemisphereNode> gauss_rings(int rings, int azimuths);

/// integral over the upper hemisphere of s(r) mu_r dOmega_r, in the unit of s times sr: pi for s = 1. So the shape table
/// of a standard with an 8/h certificate is normalised by integrate_hemisphere(s at theta_i = 8 deg).value / pi.
/// Gauss rings, doubled until two of them agree to `relative_tolerance` (of the value, or of the integral of |s| where s
/// changes sign) or 256 rings are reached. A kink in s, as in an interpolated table, slows it to some 1e-5.
/// `s` must give finite numbers.
[[nodiscard]] Integral integrate_hemisphere(const std::function<double(const Direction&)>& s,
                                            double relative_tolerance = 1e-6);

}  // namespace gonio::reflectance
