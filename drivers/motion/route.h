#pragma once

#include <vector>

#include "base/result.h"
#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::drivers {

/// Whether each axis rests with its slack taken up on its approach side, as far as is known.
using SlackTakenUp = stage::PerAxis<bool>;

/// The legs of a move from rest at `standing`, in order; at least one. The last names every axis that `target` names
/// and ends there; only it need settle. In most cases there is one leg, the target itself.
///
/// An axis with an approach side that would arrive from the other side, or over less than its overrun with its slack
/// not known to be taken up, first goes past by its overrun; the last leg then brings all such axes home together.
/// Where the keep-out blocks the direct way, legs lead round it; every leg is clear, and the last is direct. Errors:
/// OutOfLimits (an overrun beyond a soft limit: refused wherever the axis comes from, so that a plan which was accepted
/// stays possible), Blocked (the place on the path, in degrees).
[[nodiscard]] Result<std::vector<MotionTarget>> plan_route(const StageConfig& config,
                                                           const stage::PerAxis<double>& standing,
                                                           const MotionTarget& target,
                                                           const SlackTakenUp& slack_taken_up);

/// The check of `plan_route` that does not depend on where the stage stands. Errors: OutOfLimits.
[[nodiscard]] Result<void> check_approach(const StageConfig& config, const MotionTarget& target);

}  // namespace gonio::drivers
