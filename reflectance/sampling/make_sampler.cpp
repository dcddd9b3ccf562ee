#include "reflectance/sampling/make_sampler.h"

#include <utility>
#include <vector>

#include "reflectance/sampling/closed_sampler.h"
#include "reflectance/sampling/sum_sampler.h"
#include "reflectance/sampling/table_sampler.h"

namespace gonio::reflectance {
namespace {

Result<std::unique_ptr<const DirectionSampler>> make_sum(const Surface& surface, const Direction& i,
                                                         const SamplerOptions& options) {
  std::vector<SumSampler::Term> terms;
  for (const SurfaceTerm& term : surface.terms()) {
    const bool is_only_one = terms.empty() && &term == &surface.terms().back();
    if (term.weight == 0.0 && !is_only_one) continue;
    auto sampler = make_sampler(term.surface, i, options);
    if (!sampler) return failure(std::move(sampler).error());
    terms.push_back({.weight = term.weight, .sampler = *std::move(sampler)});
  }
  return std::make_unique<const SumSampler>(std::move(terms));
}

}  // namespace

Result<std::unique_ptr<const DirectionSampler>> make_sampler(const Surface& surface, const Direction& i,
                                                             const SamplerOptions& options) {
  if (!surface.terms().empty()) return make_sum(surface, i, options);
  if (surface.closed_sample(i, {.u = 0.5, .v = 0.5})) return std::make_unique<const ClosedSampler>(surface, i);
  return TableSampler::make(surface, i, options);
}

}  // namespace gonio::reflectance
