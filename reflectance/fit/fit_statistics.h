#pragma once

#include <span>

#include "reflectance/fit/fit_problem.h"
#include "reflectance/fit/fit_result.h"
#include "reflectance/measured/measured_scan.h"

namespace gonio::fit {

/// Fills in what a minimum is worth: parameters with u, correlation, chi-square, AICc, residuals, shifts. Of `result`
/// the model, the scan's name, the points and the kind of weights are set.
void add_statistics(FitResult& result, const reflectance::MeasuredScan& scan, const FreeNumbers& numbers,
                    std::span<const FitReading> readings, std::span<const double> place,
                    const ScanWhitening& whitening);

}  // namespace gonio::fit
