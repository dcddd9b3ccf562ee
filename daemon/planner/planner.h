#pragma once

#include "base/result.h"
#include "calibration/raw_reading.h"
#include "daemon/config/instrument.h"
#include "daemon/planner/planned_scan.h"
#include "drivers/stage.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {

/// Grows whenever the same plan and instrument could give other points or another order.
inline constexpr int kPlannerVersion = 3;

/// The points of a plan on an instrument, in the order of measurement: a pure function, for the dry run and for the
/// run. In anchor mode it has a point at the anchor for each wavelength. Of a plan with a budget only what fits into it
/// by the estimate, chosen by `share_out`. Errors: OutOfLimits (axis, value, limit, the plan's field),
/// AllPointsBlocked, Blocked (a point that the arms cannot come to from the one before, with the place on the path; the
/// anchor in the keep-out), InvalidInput (a wavelength without a filter, a look into the source without an attenuator
/// or an open place, an exposure that is none of the detector's, no points or more than 10^7).
[[nodiscard]] Result<PlannedScan> expand(const api::Plan& plan, const Instrument& instrument,
                                         const TimeExperience& experience = {});

/// Whether the detector's head stands in the source's beam: xi < asin((r_d + r_s) / min(R_d, R_s)).
[[nodiscard]] bool is_in_shadow(const Geometry& g, const Shadow& shadow);

/// Whether a point may not be visited: it lies in the shadow, or nearer to retro than the arms may come to each other.
[[nodiscard]] bool is_blocked(const Geometry& g, const Instrument& instrument);

/// Where the axes stand after homing, as the dry run takes it: at zero, or at the limit nearest to it.
[[nodiscard]] stage::PerAxis<double> home_position(const Instrument& instrument);

/// Whether an arm stands below the surface: then the detector sees no target, and straight through it looks into the
/// source.
[[nodiscard]] bool is_below_surface(const Geometry& g);

/// Where the carriage stands for a look at this target from there: below the surface at the open place, whatever the
/// target, for nothing may stand in the beam.
[[nodiscard]] Length carriage_place(const Instrument& instrument, calibration::Target target, const Geometry& g);

/// Where the axes of a point go from `standing`: the turning axes by the stage's kinematics, the soonest of all ways
/// within the limits to which the arms have a clear way (the soonest of all if none has), and the filter: below the
/// surface the one with an attenuator. Errors: OutOfLimits, InvalidInput (no such filter).
[[nodiscard]] Result<drivers::MotionTarget> axis_targets(const Geometry& g, Wavelength wavelength,
                                                         const Instrument& instrument,
                                                         const stage::PerAxis<double>& standing);

/// Checks one move asked for by hand from where the stage stands. Errors: OutOfLimits, Blocked (it would end in the
/// shadow, or the arms would meet on the way and no way round was found).
[[nodiscard]] Result<void> check_move(const drivers::MotionTarget& target, const stage::PerAxis<double>& standing,
                                      const Instrument& instrument);

}  // namespace gonio::daemon
