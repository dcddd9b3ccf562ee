#include "daemon/desks/plan_desk.h"

#include "daemon/planner/anchor.h"
#include "daemon/planner/planner.h"

namespace gonio::daemon {
namespace {

Error at_the_plans_standard(Error error, const std::string& file) {
  if (!error.where) error.where = InputLocation{file, 0, "reference.standard"};
  return error;
}

}  // namespace

Result<void> check_standard_reaches(const std::vector<ScanPoint>& points, api::ReferenceMode mode,
                                    const Geometry& anchor, const calibration::ReferenceStandard& standard) {
  if (mode == api::ReferenceMode::Absolute) return {};
  for (const ScanPoint& point : points) {
    if (point.blocked || (mode == api::ReferenceMode::Anchor && !is_at_anchor(point.geometry, anchor))) continue;
    GONIO_TRY(standard.check_reach(point.wavelength, point.geometry));
  }
  return {};
}

Result<CheckedPlan> check_plan(const api::PlanSubmission& submission, const Instrument& instrument,
                               const ReferenceShelf& shelf, UtcTime today, const TimeExperience& experience) {
  const std::string file = submission.plan_file.empty() ? "plan.toml" : submission.plan_file;
  Result<api::Plan> plan = api::parse_plan(submission.plan, file, submission.parts);
  if (!plan) return failure(plan.error());
  Result<PlannedScan> planned = expand(*plan, instrument, experience);
  if (!planned) {
    Error error = planned.error();
    if (error.where && error.where->file.empty()) error.where->file = file;
    return failure(std::move(error));
  }
  Result<ShelfEntry> reference = shelf.find(plan->reference_standard);
  if (!reference) return failure(at_the_plans_standard(reference.error(), file));
  GONIO_TRY(reference->standard->check_date(today));
  GONIO_TRY(check_standard_reaches(planned->points, plan->reference_mode, plan->anchor, *reference->standard));
  return CheckedPlan{std::move(*plan), std::move(*planned), std::move(*reference)};
}

}  // namespace gonio::daemon
