#pragma once

#include <algorithm>
#include <cmath>

#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// What a surface of mirroring facets asks of a pair of directions: the tilt beta of the facet that mirrors one into
/// the other, and the angle omega = xi/2 of incidence on it. The same bits for (i, r) and (r, i).
struct FacetTerms {
  double tan2_beta;   ///< tan^2(beta)
  double cos2_omega;  ///< cos^2(omega), at most 1
};

/// `mu_i`, `mu_r` are the cosines as the model clamps them.
[[nodiscard]] inline FacetTerms facet_terms(const Direction& i, const Direction& r, double mu_i, double mu_r) {
  const double mu_sum = mu_i + mu_r;
  const SumTerms t = sum_terms(i, r);
  const double tilt = std::sin(half_theta_difference(i, r));
  // |i + r|^2 = mu_sum^2 + level2: the part along the surface as a sum of squares, so that it vanishes at specular.
  const double level2 = 4.0 * (t.rise2 * (tilt * tilt) + t.sines * t.facing2);
  return {.tan2_beta = level2 / (mu_sum * mu_sum), .cos2_omega = std::min(1.0, 0.25 * (mu_sum * mu_sum + level2))};
}

}  // namespace gonio::reflectance
