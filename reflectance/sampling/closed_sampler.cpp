#include "reflectance/sampling/closed_sampler.h"

#include <cassert>
#include <cmath>

#include "reflectance/integral/directional_reflectance.h"

namespace gonio::reflectance {

ClosedSampler::ClosedSampler(const Surface& surface, const Direction& i) : DirectionSampler(i), surface_(surface) {
  assert(surface.closed_sample(i, {.u = 0.5, .v = 0.5}));
  const Integral rho = rho_dh(surface, i);
  report_ = {.method = SamplingMethod::Closed,
             .rho_dh = rho.value,
             .rho_dh_error = rho.error,
             .most_weight = rho.value,
             .evaluations = rho.evaluations};
}

void ClosedSampler::draw_run(const RandomStream& stream, std::span<const std::uint64_t> indices,
                             const SampleBatch& out) const {
  for (std::size_t n = 0; n < indices.size(); ++n) {
    const DirectionSample sample = *surface_.closed_sample(incidence(), stream.point(indices[n]));
    const Vector r = sample.r.vector();
    out.x[n] = r.x;
    out.y[n] = r.y;
    out.z[n] = r.z;
    out.weight[n] = sample.weight;
    out.is_specular[n] = sample.is_specular ? 1 : 0;
  }
}

}  // namespace gonio::reflectance
