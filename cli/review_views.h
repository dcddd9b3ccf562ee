#pragma once

#include "cli/output.h"
#include "protocol/api/scan_review.h"

namespace gonio::cli {

/// A check a row.
[[nodiscard]] Table view(const api::ScanChecksReport& report);
[[nodiscard]] bool has_failed(const api::ScanChecksReport& report);

/// What a reviewer signs: value, interval, method.
[[nodiscard]] Table budget_head(const api::PointBudgetReport& budget);
/// A component a row, the largest share first.
[[nodiscard]] Table view(const api::PointBudgetReport& budget);

}  // namespace gonio::cli
