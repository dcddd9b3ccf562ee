#include <algorithm>
#include <cassert>

#include "reflectance/surface/surface.h"
#include "reflectance/surface/surface_sum.h"

namespace gonio::reflectance {

void Surface::eval_fast(const Direction& i, std::span<const Direction> r, std::span<Brdf> out) const {
  assert(r.size() == out.size());
  if (!fast_path().has_kernel) return eval(i, r, out);
  DirectionBlock block;
  BrdfBlock values;
  for (std::size_t first = 0; first < r.size(); first += DirectionBlock::kSize) {
    const std::size_t count = std::min(DirectionBlock::kSize, r.size() - first);
    block.assign(r.subspan(first, count));
    eval_fast(i, block, values);
    std::copy_n(values.begin(), count, out.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

void SurfaceSum::eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f) const {
  f.fill({});
  BrdfBlock part;
  for (const SurfaceTerm& term : terms_) {
    term.surface.eval_fast(i, r, part);
    for (std::size_t k = 0; k < f.size(); ++k) f[k] += term.weight * part[k];
  }
}

}  // namespace gonio::reflectance
