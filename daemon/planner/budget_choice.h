#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "daemon/config/instrument.h"
#include "daemon/planner/planned_scan.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {

/// A direction of a plan while its budget is shared out.
struct BudgetCandidate {
  ScanPoint point;
  int repeats = 1;  ///< as often as the plan asks for it
  int part = 0;     ///< the part of the plan that asks for it
  int unit = 0;     ///< what is kept or left out together: a ring's azimuths of one spacing, a reciprocal pair
  int level = -1;   ///< of rings: the lower ones are kept first; -1: by distance
};

/// How often each candidate is measured, by index; 0: left out. Points that are blocked cost nothing and stay.
struct BudgetShare {
  std::vector<int> repeats;
  BudgetChoice choice;
};

/// Shares out a plan's budget. First a reading's signal-to-noise comes down, as far as the plan allows; then repeats
/// are left out, the last ones first; then directions. The next direction to be kept is always the one that lies
/// farthest from those kept, where the author asked for a finer grid sooner; parts take turns by their sizes, and each
/// keeps one unit at least. Rings lose azimuths, all rings alike and evenly, so that the quadrature over the angle
/// stays whole. As much is kept as the predicted time allows, by the order that the scan will have. Deterministic.
/// Errors: InvalidInput (not even one unit of each part fits: the time that it takes, and the budget); those of
/// measuring_order.
[[nodiscard]] Result<BudgetShare> share_out(const api::Plan& plan, const Instrument& instrument,
                                            const TimeExperience& experience,
                                            std::span<const BudgetCandidate> candidates);

}  // namespace gonio::daemon
