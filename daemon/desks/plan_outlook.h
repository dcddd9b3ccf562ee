#pragma once

#include <cstdint>
#include <vector>

#include "calibration/reference_standard.h"
#include "daemon/config/instrument.h"
#include "daemon/planner/planned_scan.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {

/// What a scan would be worth and would need, before anything is measured.
struct PlanOutlook {
  double median_relative_u = 0.0;  ///< U / f at k = 2, over the points that are not blocked
  double worst_relative_u = 0.0;
  std::vector<double> relative_u;  ///< of each, in the order of measurement
  std::int64_t visits = 0;         ///< of the dark, the standard and the sample
  std::int64_t disk_bytes = 0;     ///< with one frame an item, frames themselves not kept
};

/// Taken into U: the certificate, the shape table's modes and interpolation, the noise of both readings, placing and
/// lamp. The noise is what `target_snr` allows; where the plan says about what the sample reflects and past scans say
/// what the standard looks like, that of the exposures that the run would choose, signals too weak for the target
/// included. Left out: what depends on the sample's slopes along the angles, and on the scan's own darks.
[[nodiscard]] PlanOutlook outlook(const api::Plan& plan, const PlannedScan& planned, const Instrument& instrument,
                                  const calibration::ReferenceStandard& standard);

}  // namespace gonio::daemon
