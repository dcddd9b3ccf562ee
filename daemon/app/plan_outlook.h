#pragma once

#include "calibration/reference_standard.h"
#include "daemon/config/instrument.h"
#include "daemon/planner/planned_scan.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {

/// What a scan would be worth and would need, before anything is measured.
struct PlanOutlook {
  double median_relative_u = 0.0;  ///< U / f at k = 2, over the points that are not blocked
  double worst_relative_u = 0.0;
  double u_estimate_s = 0.0;    ///< standard uncertainty of the estimated time
  std::int64_t visits = 0;      ///< of the dark, the standard and the sample
  std::int64_t disk_bytes = 0;  ///< with one frame an item, frames themselves not kept
};

/// Taken into U: the certificate, the shape table's modes and interpolation, the noise that `target_snr` allows in both
/// readings, placing and lamp. Left out: what depends on the sample (slopes along the angles, signals too weak for the
/// target) and on the scan's own darks. So it is what the best of samples would have. The time's uncertainty is that of
/// the exposures, which are chosen by signals nobody knows yet: any between the shortest and the longest, evenly in
/// their logarithm; and two per cent of motion.
[[nodiscard]] PlanOutlook outlook(const api::Plan& plan, const PlannedScan& planned, const Instrument& instrument,
                                  const calibration::ReferenceStandard& standard);

}  // namespace gonio::daemon
