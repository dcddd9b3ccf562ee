#include "reflectance/surface/surface_sum.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace gonio::reflectance {

Result<SurfaceSum> SurfaceSum::make(std::vector<SurfaceTerm> terms) {
  if (terms.empty()) {
    return failure(
        {.code = ErrorCode::InvalidInput, .tried = "sum surfaces", .seen = "no surface", .limit = "at least one"});
  }
  for (std::size_t k = 0; k < terms.size(); ++k) {
    if (std::isfinite(terms[k].weight) && terms[k].weight >= 0.0) continue;
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = "sum surfaces",
                    .seen = fmt::format("{}.weight = {}", k + 1, terms[k].weight),
                    .limit = "finite, at least 0",
                    .where = InputLocation{.file = {}, .field = "weight"}});
  }
  return SurfaceSum(std::move(terms));
}

double SurfaceSum::specular(const Direction& i) const {
  double sum = 0.0;
  for (const SurfaceTerm& term : terms_) sum += term.weight * term.surface.specular(i);
  return sum;
}

Parameters SurfaceSum::parameters() const {
  Parameters all;
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    all.push_back({fmt::format("{}.weight", k + 1), terms_[k].weight});
    for (const NamedNumber& p : terms_[k].surface.parameters())
      all.push_back({fmt::format("{}.{}", k + 1, p.name), p.value});
  }
  return all;
}

bool SurfaceSum::is_isotropic() const {
  return std::ranges::all_of(terms_, [](const SurfaceTerm& term) { return term.surface.is_isotropic(); });
}

Feature SurfaceSum::feature() const {
  Feature hardest = Feature::Smooth;
  for (const SurfaceTerm& term : terms_) hardest = std::max(hardest, term.surface.feature());
  return hardest;
}

}  // namespace gonio::reflectance
