#pragma once

#include <optional>

#include "base/units.h"
#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::drivers {

/// A path that comes so near to the least angle counts as blocked.
inline constexpr Angle kPathResolution = degrees(0.02);

/// Where a path comes too near, or cannot be shown not to.
struct PathConflict {
  stage::PerAxis<double> at{};  ///< where the axes then stand
  Angle separation;             ///< of the arms, there
  Angle least;                  ///< that it had to keep
};

/// Looks along a move in which all named axes start at once from rest at `from`, each with its own speed and
/// acceleration, or along a straight line where moves are coordinated (`axes_on_leg`). Nothing: the arms keep the least
/// angle of `config.keep_out` on the whole path (proven), or the keep-out is off, or neither arm moves. A move that
/// starts too near must not come nearer, and must end clear.
///
/// Bound: between two instants the angle xi between the arms changes by no more than
///   |d theta_i| + |d theta_r| + min(sin theta_i, sin theta_r) (|d phi_i| + |d phi_r|)   (arms)
///   |d detector arm|                                                                     (turning sample)
/// with the sines at their largest in between, since each axis is monotone. So xi >= (xi0 + xi1 - bound) / 2 there.
[[nodiscard]] std::optional<PathConflict> path_conflict(const StageConfig& config, const stage::PerAxis<double>& from,
                                                        const MotionTarget& to);

}  // namespace gonio::drivers
