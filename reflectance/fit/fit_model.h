#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "reflectance/fit/fit_formula.h"
#include "reflectance/surface/surface.h"

namespace gonio::fit {

/// One number of a model, free within its bounds or fixed at its start.
struct FitParameter {
  std::string name;  ///< "k"; of a sum "1.rho", "2.weight", "2.roughness"
  double start = 0.0;
  double least = 0.0;
  double most = 1.0;
  bool is_fixed = false;
};

/// What a caller wants other than it is.
struct ParameterChange {
  std::optional<double> start = std::nullopt;
  std::optional<double> least = std::nullopt;
  std::optional<double> most = std::nullopt;
  std::optional<bool> is_fixed = std::nullopt;
};

/// A surface with free numbers: one formula, or a weighted sum of several. A weight is fixed at 1 unless its term is
/// of facets in a sum; such a term's refractive index is fixed at 1.5 instead, since both scale it alike.
class FitModel {
 public:
  /// "rpv", or "lambertian + ggx": names of `fit_formulas`. Errors: InvalidInput, with the names there are; more than
  /// four terms.
  [[nodiscard]] static Result<FitModel> make(std::string_view text);

  /// Errors: UnknownKey for a name that the model does not have; InvalidInput for a range that is empty, not finite or
  /// beyond the formula's own, or a start outside of it.
  [[nodiscard]] Result<void> change(std::string_view name, const ParameterChange& change);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::span<const FitParameter> parameters() const { return parameters_; }
  [[nodiscard]] std::size_t free_count() const;

  /// The value at a pair, and its slopes along all parameters, fixed ones among them (as many as `parameters`).
  [[nodiscard]] double value(const PairTerms& pair, std::span<const double> x, std::span<double> slopes) const;

  /// The surface of these numbers, as `make_surface` and SurfaceSum make it. Errors: theirs.
  [[nodiscard]] Result<reflectance::Surface> surface(std::span<const double> x) const;

 private:
  struct Term {
    const FitFormula* formula;
    std::size_t weight;  ///< index of its weight in the parameters; its own follow
  };

  std::string name_;
  std::vector<Term> terms_;
  std::vector<FitParameter> parameters_;
  std::vector<FitParameter> limits_;  ///< as the formulas have them
};

}  // namespace gonio::fit
