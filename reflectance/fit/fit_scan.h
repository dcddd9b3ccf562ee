#pragma once

#include <cstdint>

#include "base/result.h"
#include "reflectance/fit/fit_model.h"
#include "reflectance/fit/fit_result.h"
#include "reflectance/measured/measured_scan.h"

namespace gonio::fit {

/// What the readings count.
enum class FitWeights : std::uint8_t {
  Stated,  ///< by their covariance: u_random of each, and the shared components
  Even,    ///< all alike, u from their scatter about the fit: for files without uncertainties
};

struct FitOptions {
  FitWeights weights = FitWeights::Stated;
  int starts = 6;             ///< the model's own first, then others drawn within the bounds; 1 to 100
  std::uint64_t seed = 1;     ///< of those
  int most_iterations = 100;  ///< of each
};

/// Fits the model's free numbers to the scan's usable points by generalised least squares (JCGM 100:2008, H.3; JCGM
/// 102). Covariance: (J^T V^-1 J)^-1. Errors of shared components are taken as proportional to the value and scaled
/// with the fitted one, lest readings that are low by chance weigh more (Peelle's puzzle).
///
/// A direction in the space of the numbers along which the data tell less than an even spread over the bounds (u above
/// 1/sqrt(12) of their width) makes those that take part in it undetermined; the bounds then count as a prior.
///
/// 1e4 points and three numbers take some 0.2 s; the same inputs give the same bits. Errors: as `check` of the scan;
/// InvalidInput: a u_random of 0 with stated weights, nothing free, an option out of range, a model that is not finite.
[[nodiscard]] Result<FitResult> fit_scan(const reflectance::MeasuredScan& scan, const FitModel& model,
                                         const FitOptions& options = {});

}  // namespace gonio::fit
