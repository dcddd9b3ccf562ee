#pragma once

#include <vector>

#include "base/geometry.h"
#include "base/result.h"
#include "drivers/kinematics/kinematics_config.h"
#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::drivers {

/// The directions of source and detector, seen from the sample, when the axes stand at `positions` (in their units).
/// Arms: the angles as they stand, also beyond +-180 deg or with theta slightly below 0. Turning sample: theta in
/// [0, 180 deg], phi in (-180, 180] deg, 0 at the very pole.
[[nodiscard]] Geometry directions(const KinematicsConfig& kinematics, const stage::PerAxis<double>& positions);

/// The same directions with each phi moved by whole turns to within half a turn of that in `planned`.
[[nodiscard]] Geometry directions_near(const KinematicsConfig& kinematics, const stage::PerAxis<double>& positions,
                                       const Geometry& planned);

/// The angle between the source's and the detector's arm, in [0, 180 deg]: the phase angle.
[[nodiscard]] Angle separation(const KinematicsConfig& kinematics, const stage::PerAxis<double>& positions);

/// Every way in which the four turning axes can stand for `g` within their soft limits, the one first that is reached
/// soonest from `standing` (each axis by its own speed and acceleration). Never empty. Arms: by whole turns of phi.
/// Turning sample: both sides of the source, both ways over the pitch, whole turns of each axis nearest to where it
/// stands. A limit is kept to 1e-9 deg, and a position that lies so little beyond it stands on it.
/// Errors: OutOfLimits with the axis, its value and its limits, for the way that comes nearest to being allowed; or
/// with the phase angle, where the detector's arm cannot come so near to a source outside of its plane.
[[nodiscard]] Result<std::vector<MotionTarget>> solutions(const Geometry& g, const StageConfig& config,
                                                          const stage::PerAxis<double>& standing);

}  // namespace gonio::drivers
