#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "daemon/analysis/picture.h"
#include "protocol/api/analysis.h"
#include "reflectance/measured/measured_scan.h"

namespace gonio::analysis {

/// What a fit tells: facts and notes, the fitted surface as a scene, and pictures of what is left.
struct FitTold {
  std::vector<api::AnalysisFact> facts;
  std::vector<std::string> notes;
  std::string scene;  ///< TOML: [sample] of a simulator's scene
  Picture residuals;
};

/// Fits models ("rpv", "lambertian + ggx", several with commas between; empty: those that matte and glossy samples
/// need), and tells of the best by AICc. Without a stated uncertainty all readings weigh alike. Errors: as
/// FitModel::make, fit_models.
[[nodiscard]] Result<FitTold> fit_told(const reflectance::MeasuredScan& scan, const std::string& models,
                                       const std::string& stem);

/// rho_dh of each incidence (six at most), the albedo and R under an overcast sky where there are several incidences,
/// RADF at the normal where light fell from there; each with U, its shared parts kept, and what of it was modelled by
/// the best of the fits. Errors: as ScanQuantities.
[[nodiscard]] Result<std::vector<api::AnalysisFact>> quantities_told(const reflectance::MeasuredScan& scan,
                                                                     std::vector<std::string>& notes);

/// Two scans in units of what does not cancel between them. Errors: as compare_scans.
struct ComparisonTold {
  std::vector<api::AnalysisFact> facts;
  std::string table;  ///< CSV: both points' directions, difference, u, z
};
[[nodiscard]] Result<ComparisonTold> comparison_told(const reflectance::MeasuredScan& first,
                                                     const reflectance::MeasuredScan& second);

}  // namespace gonio::analysis
