#pragma once

#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "daemon/config/instrument.h"
#include "daemon/desks/reference_shelf.h"
#include "daemon/planner/planned_scan.h"
#include "protocol/api/plan.h"
#include "protocol/api/requests.h"

namespace gonio::daemon {

/// A plan that this instrument can run with this standard: parsed, expanded, its reference found, in date and in reach.
struct CheckedPlan {
  api::Plan plan;
  PlannedScan planned;
  ShelfEntry reference;
};

/// Whether the standard reaches what it is read at: every point that is not blocked, the anchor alone, or nothing.
/// Errors: ReferenceOutOfReach.
[[nodiscard]] Result<void> check_standard_reaches(const std::vector<ScanPoint>& points, api::ReferenceMode mode,
                                                  const Geometry& anchor,
                                                  const calibration::ReferenceStandard& standard);

/// The one check of plans, for the dry run and for the run. Errors: those of parse_plan, expand and the reference
/// shelf; ReferenceExpired, ReferenceOutOfReach.
[[nodiscard]] Result<CheckedPlan> check_plan(const api::PlanSubmission& submission, const Instrument& instrument,
                                             const ReferenceShelf& shelf, UtcTime today,
                                             const TimeExperience& experience);

}  // namespace gonio::daemon
