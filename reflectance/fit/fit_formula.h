#pragma once

#include <span>
#include <string_view>

#include "reflectance/fit/dual.h"
#include "reflectance/fit/pair_terms.h"

namespace gonio::fit {

/// One number of a formula, with where a fit looks for it. The range lies within that of the surface's model.
struct FormulaParameter {
  std::string_view name;
  double start = 0.0;
  double least = 0.0;
  double most = 1.0;
  bool is_fixed = false;  ///< unless asked for: what a fit alone seldom tells
};

/// A surface's formula with its slopes, for those models of `make_surface` that can be fitted. The same values as the
/// surface's own, to rounding.
struct FitFormula {
  std::string_view model;
  std::span<const FormulaParameter> parameters;  ///< in the order of `make_surface`'s table, at most Dual::kSlopes
  Dual (*value)(const PairTerms& pair, std::span<const double> parameters);
  bool is_facets = false;  ///< light mirrored at the top alone: in a sum its share is free and its index fixed
};

/// lambertian, minnaert, hapke, hapke_as_printed, hapke_hg, rpv, rpv_brf, cox_munk, cox_munk_smith, glint_smith,
/// beckmann, ggx, water_body.
[[nodiscard]] std::span<const FitFormula> fit_formulas();
/// Null when no formula has this name.
[[nodiscard]] const FitFormula* find_formula(std::string_view model);

}  // namespace gonio::fit
