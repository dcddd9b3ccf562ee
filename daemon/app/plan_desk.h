#pragma once

#include "base/clock.h"
#include "base/result.h"
#include "daemon/app/reference_shelf.h"
#include "daemon/config/instrument.h"
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

/// The one check of plans, for the dry run and for the run. Errors: those of parse_plan, expand and the reference
/// shelf; ReferenceExpired, ReferenceOutOfReach.
[[nodiscard]] Result<CheckedPlan> check_plan(const api::PlanSubmission& submission, const Instrument& instrument,
                                             const ReferenceShelf& shelf, UtcTime today,
                                             const TimeExperience& experience);

}  // namespace gonio::daemon
