#pragma once

#include <string>
#include <vector>

#include "calibration/reference_standard.h"
#include "daemon/config/instrument.h"
#include "daemon/planner/planned_scan.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {

/// What a plan's points would take and would be worth in one reference mode.
struct ModeOutlook {
  api::ReferenceMode mode = api::ReferenceMode::SameGeometry;
  Duration time{};
  double median_relative_u = 0.0;  ///< U / f, of a sample as white as the standard
  double worst_relative_u = 0.0;
  std::string dominant;  ///< the largest component at the worst point
  int mixed = 0;         ///< of the points looked at, where neither spot nor field of view holds the other
  int looked_at = 0;
  std::string refused;  ///< not empty: why the mode cannot be had; the figures are then 0
};

/// All modes, in the order of their enumerators, by the estimate of the planner and the budget of the calibration
/// (calibration/expected_budget.h). Budgets are those of some 200 points, evenly along the order. An anchor that the
/// plan does not name is at 0/45, and visited every block.
[[nodiscard]] std::vector<ModeOutlook> mode_outlooks(const api::Plan& plan, const PlannedScan& planned,
                                                     const Instrument& instrument,
                                                     const calibration::ReferenceStandard& standard);

}  // namespace gonio::daemon
