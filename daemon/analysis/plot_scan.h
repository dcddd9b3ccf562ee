#pragma once

#include <string>
#include <vector>

#include "daemon/analysis/budget_summary.h"
#include "daemon/analysis/picture.h"
#include "daemon/store/scan_history.h"

namespace gonio::analysis {

/// What each component does to the values: bars to the median, a line on to the worst point.
[[nodiscard]] Picture budget_picture(const std::string& stem, const std::vector<BudgetLine>& lines);

/// The lamp's monitor, the levels of the standard and of the sample seen by visits, the dark, and the environment, by
/// minutes since the scan's first reading.
[[nodiscard]] Picture drift_picture(const std::string& stem, const daemon::ScanHistory& history);

}  // namespace gonio::analysis
