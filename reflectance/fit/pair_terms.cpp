#include "reflectance/fit/pair_terms.h"

#include "reflectance/surface/clamped_cosine.h"
#include "reflectance/surface/facet_terms.h"

namespace gonio::fit {

PairTerms pair_terms(const reflectance::Direction& i, const reflectance::Direction& r) {
  const double mu_i = reflectance::clamped_mu(i);
  const double mu_r = reflectance::clamped_mu(r);
  const reflectance::SeparationTerms apart = reflectance::separation_terms(i, r);
  const reflectance::FacetTerms facet = reflectance::facet_terms(i, r, mu_i, mu_r);
  return {.mu_i = mu_i,
          .mu_r = mu_r,
          .sin_i = i.sin_theta(),
          .sin_r = r.sin_theta(),
          .cos_xi = 1.0 - 2.0 * reflectance::sin2_half_phase(apart),
          .retro_distance = reflectance::retro_distance(apart, mu_i * mu_r),
          .tan2_beta = facet.tan2_beta,
          .cos_omega = std::sqrt(facet.cos2_omega)};
}

}  // namespace gonio::fit
