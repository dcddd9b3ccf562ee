// The models that need neither an angle nor a half vector.
#include <numbers>

#include "reflectance/batch/lane_loop.h"
#include "reflectance/batch/vector_math.h"
#include "reflectance/surface/fresnel_mirror.h"
#include "reflectance/surface/lambertian.h"
#include "reflectance/surface/minnaert.h"
#include "reflectance/surface/water_body.h"

namespace gonio::reflectance {

void Lambertian::eval_fast(const Direction&, const DirectionBlock&, BrdfBlock& f, VectorUnit) const {
  f.fill(f_);
}

void FresnelMirror::eval_fast(const Direction&, const DirectionBlock&, BrdfBlock& f, VectorUnit) const {
  f.fill({});
}

void Minnaert::eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f, VectorUnit unit) const {
  const double scale = p_.rho / std::numbers::pi;
  const double mu_i = clamped_mu(i);
  const lane::Exponent exponent(p_.k);
  const double* const mu = r.mu.data();
  Brdf* const __restrict out = f.data();
  for_each_lane(unit, [=](std::size_t k) GONIO_INLINED {
    out[k] = per_steradian(scale * lane::power(mu_i * lane::most(mu[k], kLeastMu), exponent));
  });
}

// fresnel_transmittance for n >= 1, the same operations in the same order: the same bits.
void WaterBody::eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f, VectorUnit unit) const {
  const double scale = scale_;
  const double passed_i = passed(i);
  const double n = p_.refractive_index;
  const double* const mu = r.mu.data();
  Brdf* const __restrict out = f.data();
  for_each_lane(unit, [=](std::size_t k) GONIO_INLINED {
    const double cosine = lane::most(mu[k], kLeastMu);
    const double t2 = ((n - 1.0) * (n + 1.0) + cosine * cosine) / (n * n);
    const double t = lane::root(lane::most(t2, 0.0));
    const double across = cosine + n * t;
    const double in_plane = n * cosine + t;
    const double passed_r = 2.0 * n * cosine * t * (1.0 / (across * across) + 1.0 / (in_plane * in_plane));
    out[k] = per_steradian(scale * (passed_i * (t2 <= 0.0 ? 0.0 : passed_r)));
  });
}

}  // namespace gonio::reflectance
