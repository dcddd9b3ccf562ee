#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// The weighted sum of surfaces, as a diffuse body under a gloss: f = sum of weight_k f_k, mirror parts likewise.
/// It does not model what the upper part keeps from the lower: that is in the weights, or in a surface of its own.
class SurfaceSum {
 public:
  /// At least one term; weights finite and at least 0. Errors: InvalidInput.
  [[nodiscard]] static Result<SurfaceSum> make(std::vector<SurfaceTerm> terms);

  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    Brdf sum;
    for (const SurfaceTerm& term : terms_) sum += term.weight * term.surface.eval(i, r);
    return sum;
  }
  void eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f) const;
  /// That of the farthest term, and the rounding of the sum.
  [[nodiscard]] FastPath fast_path() const;
  [[nodiscard]] double specular(const Direction& i) const;

  /// "sum"; files name its terms.
  [[nodiscard]] std::string_view model() const { return "sum"; }
  /// Those of the terms: "1.weight", "1.rho", "2.weight", ...
  [[nodiscard]] Parameters parameters() const;
  [[nodiscard]] bool is_isotropic() const;
  /// The hardest of its terms.
  [[nodiscard]] Feature feature() const;
  [[nodiscard]] std::span<const SurfaceTerm> terms() const { return terms_; }

 private:
  explicit SurfaceSum(std::vector<SurfaceTerm> terms) : terms_(std::move(terms)) {}
  std::vector<SurfaceTerm> terms_;
};

}  // namespace gonio::reflectance
