#pragma once

#include <vector>

#include "base/result.h"
#include "protocol/api/analysis.h"
#include "reflectance/formats/measured_brdf.h"

namespace gonio::analysis {

/// What is in a BRDF and what it integrates to: points, incidences, the least and the largest value; for each channel
/// and up to six incidences rho_dh with the share of its weight that was not measured; what each reading differs by
/// from what its neighbours say (cross-validation), among views and among incidences, RMS relative to mean |f|. Errors:
/// as `formats::check`. Channels that make no surface are noted in `notes` and have no integral.
[[nodiscard]] Result<std::vector<api::AnalysisFact>> describe_brdf(const formats::MeasuredBrdf& brdf,
                                                                   std::vector<std::string>& notes);

}  // namespace gonio::analysis
