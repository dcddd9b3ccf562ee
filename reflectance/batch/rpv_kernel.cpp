#include "reflectance/batch/lane_loop.h"
#include "reflectance/batch/lane_terms.h"
#include "reflectance/batch/vector_math.h"
#include "reflectance/surface/rpv.h"

namespace gonio::reflectance {

// As Rpv::eval, lane by lane; retro_distance written out.
void Rpv::eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f, VectorUnit unit) const {
  SeparationRows t;
  Row phase;
  fill(t, i, r, unit);
  fill_phase(phase, phase_, t, i, r, unit);

  const double scale = scale_;
  const double mu_i = clamped_mu(i);
  const double beyond_level = 1.0 - p_.rho0;
  const lane::Exponent exponent(p_.k - 1.0);
  const SeparationRows* const terms = &t;
  const double* const by_phase = phase.data();
  const double* const mu = r.mu.data();
  Brdf* const __restrict out = f.data();
  for_each_lane(unit, [=](std::size_t k) GONIO_INLINED {
    const double mu_r = lane::most(mu[k], kLeastMu);
    const double product = mu_i * mu_r;
    const double sin2_tilt = 4.0 * terms->tilt2[k] * (1.0 - terms->tilt2[k]);
    const double distance = lane::root(sin2_tilt + 4.0 * product * terms->sines[k] * terms->turn2[k]) / product;
    const double hot_spot = 1.0 + beyond_level / (1.0 + distance);
    const double bowl = lane::power(product * (mu_i + mu_r), exponent);
    out[k] = per_steradian(scale * bowl * by_phase[k] * hot_spot);
  });
}

}  // namespace gonio::reflectance
