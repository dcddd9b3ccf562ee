#pragma once

#include <string>

#include "base/result.h"
#include "daemon/analysis/told.h"
#include "reflectance/fit/fit_result.h"
#include "reflectance/measured/measured_scan.h"

namespace gonio::analysis {

/// The model of this name fitted to the scan. Errors: as FitModel::make, fit_scan.
[[nodiscard]] Result<fit::FitResult> fitted_model(const reflectance::MeasuredScan& scan, const std::string& model);

/// Fits models ("rpv", "lambertian + ggx", several with commas between; empty: those that matte and glossy samples
/// need), and tells of the best by AICc: its numbers, the fitted surface as a scene (".toml"), a picture of what is
/// left. Without a stated uncertainty all readings weigh alike. Errors: as FitModel::make, fit_models.
[[nodiscard]] Result<Told> fit_told(const reflectance::MeasuredScan& scan, const std::string& models,
                                    const std::string& stem);

/// rho_dh of each incidence (six at most), the albedo and R under an overcast sky where there are several incidences,
/// RADF at the normal where light fell from there; each with U, its shared parts kept, and what of it was modelled by
/// the best of the fits. Errors: as ScanQuantities.
[[nodiscard]] Result<Told> quantities_told(const reflectance::MeasuredScan& scan);

}  // namespace gonio::analysis
