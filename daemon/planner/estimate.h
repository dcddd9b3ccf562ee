#pragma once

#include <span>

#include "base/result.h"
#include "daemon/config/instrument.h"
#include "daemon/planner/planned_scan.h"
#include "drivers/stage.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {

/// The time of a scan of `points` (by index) in this order, by the plan's mode with the way back on the reference or
/// without it, all visits included, by the instrument's own speeds and
/// what past scans took beside them; light by `LightForecast`. Every direction must be within the axes' limits
/// (asserted). Detours and turning points count. In `read` stands what an item takes beyond motion and light. Errors:
/// Blocked (a point that the arms cannot come to from the one before, with the place on the path).
[[nodiscard]] Result<TimeParts> estimate(const api::Plan& plan, const Instrument& instrument,
                                         std::span<const ScanPoint> points, std::span<const std::int32_t> order,
                                         const TimeExperience& experience = {});

/// The standard uncertainty of a scan's `estimate`: that of the light nobody has seen yet, and the scatter of past
/// scans in motion and in what an item takes beyond.
[[nodiscard]] double u_of_estimate_s(const api::Plan& plan, const Instrument& instrument, const PlannedScan& planned);

/// How long one axis needs from rest to rest; without settling.
[[nodiscard]] Duration travel_time(const drivers::AxisConfig& axis, double way);

/// How long the axes need together for one step, all its legs, and how long they then settle: the slowest of those that
/// move. Axes are taken to rest with their slack taken up. Errors: those of drivers::plan_route.
struct StepTime {
  Duration move{};
  Duration settle{};
};
[[nodiscard]] Result<StepTime> step_time(const Instrument& instrument, const stage::PerAxis<double>& from,
                                         const drivers::MotionTarget& to);

}  // namespace gonio::daemon
