#pragma once

#include "reflectance/direction/direction.h"

namespace gonio::fit {

/// What the formulas ask of a pair of directions, made once for a fit.
struct PairTerms {
  double mu_i = 1.0;  ///< clamped, as in surface/clamped_cosine.h
  double mu_r = 1.0;
  double sin_i = 0.0;
  double sin_r = 0.0;
  double cos_xi = 1.0;          ///< of the phase angle
  double retro_distance = 0.0;  ///< G of eq 8
  double tan2_beta = 0.0;       ///< of the facet that mirrors one into the other
  double cos_omega = 1.0;       ///< of the angle of incidence on it
};
[[nodiscard]] PairTerms pair_terms(const reflectance::Direction& i, const reflectance::Direction& r);

}  // namespace gonio::fit
