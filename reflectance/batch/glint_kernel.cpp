#include <numbers>

#include "reflectance/batch/lane_loop.h"
#include "reflectance/batch/lane_terms.h"
#include "reflectance/batch/vector_math.h"
#include "reflectance/surface/glint.h"

namespace gonio::reflectance {
namespace {

// fresnel(cos_theta, sin_theta, n).unpolarised() for n >= 1.
GONIO_LANE double fresnel_share(double cos_theta, double sin_theta, double n, double contrast) {
  const double ratio = sin_theta / n;
  const double t2 = ((n - 1.0) * (n + 1.0) + cos_theta * cos_theta) / (n * n);
  const double t = lane::root(lane::most(t2, 0.0));
  const double across = cos_theta + n * t;
  const double in_plane = n * cos_theta + t;
  const double r_s = contrast / (across * across);
  const double r_p = -contrast * (cos_theta - ratio) * (cos_theta + ratio) / (in_plane * in_plane);
  return t2 <= 0.0 ? 1.0 : 0.5 * (r_s * r_s + r_p * r_p);
}

}  // namespace

// 1 / (1 + Lambda_i + Lambda_r) with Lambda = e^(-v^2) (1/(v sqrt(pi)) - e^(v^2) erfc(v)) / 2.
void Glint::fill_visible_shares(double* shares, const Direction& i, const DirectionBlock& r, VectorUnit unit) const {
  double* const __restrict out = shares;
  const double* const mu = r.mu.data();
  const double* const sin_theta = r.sin_theta.data();
  const double deviation = deviation_;
  const double one_and_hidden = 1.0 + hidden_ratio(i);
  constexpr double kReach = 6.0;
  for_each_lane(unit, [=](std::size_t k) GONIO_INLINED {
    const double mu_r = lane::most(mu[k], kLeastMu);
    const double run = deviation * sin_theta[k];
    const bool is_free = mu_r > kReach * run;
    const double v = is_free ? kReach : mu_r / run;
    const double tail = 1.0 / (v * lane::root(std::numbers::pi)) - lane::scaled_erfc(v);
    const double hidden = 0.5 * lane::exponential(-v * v) * tail;
    out[k] = 1.0 / (one_and_hidden + (is_free ? 0.0 : hidden));
  });
}

// As Glint::eval, lane by lane.
void Glint::eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f, VectorUnit unit) const {
  SumRows t;
  Row shares;
  fill(t, i, r, unit);
  if (p_.shadowing == Shadowing::None)
    shares.fill(1.0);
  else
    fill_visible_shares(shares.data(), i, r, unit);

  const double mu_i = clamped_mu(i);
  const double n = p_.refractive_index;
  const double contrast = (1.0 - n) * (1.0 + n);
  const double variance = p_.slope_variance;
  const double peak = peak_;
  const SumRows* const terms = &t;
  const double* const visible = shares.data();
  const double* const mu = r.mu.data();
  Brdf* const __restrict out = f.data();
  for_each_lane(unit, [=](std::size_t k) GONIO_INLINED {
    const double mu_r = lane::most(mu[k], kLeastMu);
    const double mu_sum = mu_i + mu_r;
    const double level2 = 4.0 * (terms->rise2[k] * terms->tilt2[k] + terms->sines[k] * terms->facing2[k]);
    const double tan2_beta = level2 / (mu_sum * mu_sum);
    const double cos2_omega = lane::least(1.0, 0.25 * (mu_sum * mu_sum + level2));
    const double share = fresnel_share(lane::root(cos2_omega), lane::root(1.0 - cos2_omega), n, contrast);
    const double per_cos4 = (1.0 + tan2_beta) * (1.0 + tan2_beta);
    const double depth = tan2_beta / variance;
    const double facets = peak * lane::exponential(-lane::least(depth, kDeepest));
    const double value = share * facets * per_cos4 / (4.0 * (mu_i * mu_r)) * visible[k];
    out[k] = per_steradian(depth > kDeepest ? 0.0 : value);
  });
}

}  // namespace gonio::reflectance
