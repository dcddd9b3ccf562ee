#include "reflectance/batch/lane_loop.h"
#include "reflectance/batch/lane_terms.h"
#include "reflectance/batch/vector_math.h"
#include "reflectance/surface/hapke.h"

namespace gonio::reflectance {

// H H, or beside a phase function H H - 1.
void Hapke::fill_higher_orders(double* orders, const Direction& i, const DirectionBlock& r, VectorUnit unit) const {
  double* const __restrict out = orders;
  const double* const mu = r.mu.data();
  const double mu_i = clamped_mu(i);
  const bool is_isotropic = p_.g == 0.0;
  if (exact_) {
    // A table of polynomials, one chosen for each lane: no faster by gathering the coefficients of four or eight lanes.
    const double log_h_i = exact_->log(mu_i);
    for (std::size_t k = 0; k < DirectionBlock::kSize; ++k) out[k] = log_h_i + exact_->log(std::max(mu[k], kLeastMu));
    if (is_isotropic)
      for_each_lane(unit, [=](std::size_t k) GONIO_INLINED { out[k] = lane::exponential(out[k]); });
    else
      for_each_lane(unit, [=](std::size_t k) GONIO_INLINED { out[k] = lane::exponential_less_one(out[k]); });
    return;
  }
  const double b = b_;
  if (is_isotropic) {
    const double a = a_;
    const double h_i = approximate_h(mu_i);
    for_each_lane(unit, [=](std::size_t k) GONIO_INLINED {
      const double mu_r = lane::most(mu[k], kLeastMu);
      out[k] = h_i * ((1.0 + a * mu_r) / (1.0 + b * mu_r));
    });
    return;
  }
  const double rise = rise_;
  const double more_i = rise * mu_i / (1.0 + b * mu_i);
  for_each_lane(unit, [=](std::size_t k) GONIO_INLINED {
    const double mu_r = lane::most(mu[k], kLeastMu);
    const double more_r = rise * mu_r / (1.0 + b * mu_r);
    out[k] = more_i + more_r + more_i * more_r;
  });
}

void Hapke::eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f, VectorUnit unit) const {
  Row orders;
  Row phase;
  fill_higher_orders(orders.data(), i, r, unit);
  if (p_.g == 0.0) {
    phase.fill(0.0);
  } else {
    SeparationRows t;
    fill(t, i, r, unit);
    fill_phase(phase, phase_, t, i, r, unit);
  }

  const double scale = scale_;
  const double mu_i = clamped_mu(i);
  const double* const mu = r.mu.data();
  const double* const first = phase.data();
  const double* const higher = orders.data();
  Brdf* const __restrict out = f.data();
  for_each_lane(unit, [=](std::size_t k) GONIO_INLINED {
    const double mu_r = lane::most(mu[k], kLeastMu);
    out[k] = per_steradian(scale * (first[k] + higher[k]) / (mu_i + mu_r));
  });
}

}  // namespace gonio::reflectance
