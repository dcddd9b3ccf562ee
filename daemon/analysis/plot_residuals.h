#pragma once

#include <string>

#include "daemon/analysis/picture.h"
#include "reflectance/fit/fit_result.h"

namespace gonio::analysis {

/// What a fit leaves: z of each reading by phase angle, and its map over directions.
[[nodiscard]] Picture residuals_picture(const std::string& stem, const fit::FitResult& fit);

}  // namespace gonio::analysis
