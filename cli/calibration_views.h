#pragma once

#include <string>

#include "cli/output.h"
#include "protocol/api/calibration_reports.h"

namespace gonio::cli {

/// What calibration jobs have found, a row each.
[[nodiscard]] Table view(const api::CalibrationList& calibrations);
/// One version: its values with u and correlations, how it fitted, its history.
[[nodiscard]] Table view(const api::CalibrationReport& calibration);
/// The runs of a check standard, a row each.
[[nodiscard]] Table view(const api::ChartReport& chart);

/// "mean REFF of ...: centre 0.98765, limits 0.9855 to 0.9898 (3 sd of 10 runs). the last run is in control"
[[nodiscard]] std::string chart_sentence(const api::ChartReport& chart);

}  // namespace gonio::cli
