#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "reflectance/fit/fit_result.h"
#include "reflectance/fit/fit_scan.h"
#include "reflectance/measured/cap_model.h"

namespace gonio::fit {

/// One fit among several of the same readings.
struct RankedFit {
  std::size_t fit = 0;  ///< its index
  std::string model;
  double aicc = 0.0;
  double delta = 0.0;   ///< above the best
  double weight = 0.0;  ///< Akaike's: the likelihoods exp(-delta/2), their sum 1 (Burnham and Anderson 2002, eq 2.9)
};

/// Best first. A model that does not fit may still be the best of those that were tried: p tells that. Errors:
/// InvalidInput for no fits, or fits of different numbers of points or kinds of weights.
[[nodiscard]] Result<std::vector<RankedFit>> rank_fits(std::span<const FitResult> fits);

/// Each model fitted to the scan. Errors: of the first that cannot be.
[[nodiscard]] Result<std::vector<FitResult>> fit_models(const reflectance::MeasuredScan& scan,
                                                        std::span<const FitModel> models,
                                                        const FitOptions& options = {});

/// The best of the fits as what stands where nothing was measured (measured/cap_model.h), with the dependence of its
/// numbers on the readings, and the others as its rivals by their weights; where the best does not fit (p < 0.001, or
/// no p) these go as 1 / chi2. What the fit leaves of the readings is its `u_lack_of_fit` then. Errors:
/// as rank_fits; as FitModel::surface.
[[nodiscard]] Result<reflectance::CapModel> cap_of(std::span<const FitResult> fits);

}  // namespace gonio::fit
