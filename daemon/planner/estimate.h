#pragma once

#include "daemon/config/instrument.h"
#include "daemon/planner/planned_scan.h"
#include "drivers/stage.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {

/// The time of a planned scan, dark visits included, by the instrument's own speeds: `planned.points` and
/// `planned.order` are read. Every direction must be within the axes' limits (asserted).
[[nodiscard]] TimeParts estimate(const api::Plan& plan, const Instrument& instrument, const PlannedScan& planned);

/// How long one axis needs from rest to rest; without settling.
[[nodiscard]] Duration travel_time(const drivers::AxisConfig& axis, double way);

/// How long the axes need together for one step, and how long they then settle: the slowest of those that move.
struct StepTime {
  Duration move{};
  Duration settle{};
};
[[nodiscard]] StepTime step_time(const Instrument& instrument, const stage::PerAxis<double>& from,
                                 const drivers::MotionTarget& to);

}  // namespace gonio::daemon
