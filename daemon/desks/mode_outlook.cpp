#include "daemon/desks/mode_outlook.h"

#include <algorithm>
#include <utility>

#include "calibration/expected_budget.h"
#include "daemon/planner/estimate.h"
#include "daemon/planner/planner.h"
#include "daemon/sequencer/visit_level.h"

namespace gonio::daemon {
namespace {

using api::ReferenceMode;

// The plan as it would be in that mode.
api::Plan in_mode(api::Plan plan, ReferenceMode mode) {
  if (mode == ReferenceMode::Anchor && plan.reference_every <= Duration::zero()) plan.reference_every = plan.block;
  plan.reference_mode = mode;
  return plan;
}

Result<void> check_anchor(const api::Plan& plan, const Instrument& instrument, Wavelength wavelength) {
  const auto target = axis_targets(plan.anchor, wavelength, instrument, home_position(instrument));
  if (!target) return failure(target.error());
  if (!is_blocked(plan.anchor, instrument)) return {};
  return failure(Error{.code = ErrorCode::Blocked,
                       .device = "plan",
                       .tried = "read the standard at the anchor",
                       .seen = "it lies in the keep-out"});
}

Result<void> add_time(const api::Plan& plan, const PlannedScan& planned, const Instrument& instrument,
                      ModeOutlook& outlook) {
  if (plan.reference_mode == ReferenceMode::Anchor) {
    GONIO_TRY(check_anchor(plan, instrument, planned.points.front().wavelength));
  }
  const auto time = estimate(plan, instrument, planned.points, planned.order, planned.experience);
  if (!time) return failure(time.error());
  outlook.time = time->total();
  return {};
}

Error no_surface() {
  return {.code = ErrorCode::IncompleteData,
          .device = "plan",
          .tried = "foresee the uncertainty of a BRDF",
          .seen = "a look into the source, past all targets"};
}

Result<void> add_budgets(const api::Plan& plan, const PlannedScan& planned, const Instrument& instrument,
                         const calibration::ReferenceStandard& standard, ModeOutlook& outlook) {
  constexpr std::size_t kLookedAt = 200;
  const bool is_in_blocks = plan.reference_mode == ReferenceMode::SameGeometry;
  const calibration::Expectation expectation{
      .mode = static_cast<calibration::ReferenceMode>(plan.reference_mode),  // the same order
      .anchor = plan.anchor,
      .snr = plan.target_snr,
      .visit_snr = visit_snr(plan.drift_limit),
      .apart = is_in_blocks ? plan.block / 2 : plan.reference_every / 2};
  std::vector<double> all;
  const std::size_t step = std::max<std::size_t>(1, planned.order.size() / kLookedAt);
  for (std::size_t k = 0; k < planned.order.size(); k += step) {
    const ScanPoint& point = planned.points[static_cast<std::size_t>(planned.order[k])];
    if (is_below_surface(point.geometry)) return failure(no_surface());
    auto budget =
        calibration::expected_budget(point.geometry, point.wavelength, expectation, instrument.model, standard);
    if (!budget) return failure(std::move(budget).error());
    outlook.mixed += budget->is_mixed ? 1 : 0;
    if (budget->relative_u > outlook.worst_relative_u) {
      outlook.worst_relative_u = budget->relative_u;
      outlook.dominant = std::move(budget->dominant);
    }
    all.push_back(budget->relative_u);
  }
  outlook.looked_at = static_cast<int>(all.size());
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  outlook.median_relative_u = *middle;
  return {};
}

}  // namespace

std::vector<ModeOutlook> mode_outlooks(const api::Plan& plan, const PlannedScan& planned, const Instrument& instrument,
                                       const calibration::ReferenceStandard& standard) {
  std::vector<ModeOutlook> outlooks;
  for (const ReferenceMode mode : {ReferenceMode::SameGeometry, ReferenceMode::Anchor, ReferenceMode::Absolute}) {
    const api::Plan variant = in_mode(plan, mode);
    ModeOutlook outlook{.mode = mode};
    Result<void> done = add_budgets(variant, planned, instrument, standard, outlook);
    if (done) done = add_time(variant, planned, instrument, outlook);
    if (!done) outlook = {.mode = mode, .refused = done.error().seen};
    outlooks.push_back(std::move(outlook));
  }
  return outlooks;
}

}  // namespace gonio::daemon
