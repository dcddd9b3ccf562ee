#pragma once

#include <vector>

#include "base/geometry.h"
#include "base/result.h"
#include "drivers/kinematics/kinematics_config.h"

namespace gonio::drivers {

/// The turns of a turning sample and its detector arm.
///
/// Laboratory: x is the arm's zero, z is up, right-handed. The sample's body frame X, Y, Z lies along x, y, z when all
/// turns are zero, and X is its normal: the surface then faces the detector's arm. On the sample phi = 0 is Y and
/// phi = 90 deg is Z, counter-clockwise seen from outside.
///
/// Yaw, pitch, roll are right-handed turns about the body's own axes in this order: yaw about Z, pitch about the turned
/// Y, roll about the twice turned X, which is the normal. A vector of the body is in the laboratory at
///   v_lab = Rz(yaw) Ry(pitch) Rx(roll) v_body
/// (Diebel 2006, "Representing Attitude", sequence (1,2,3); Goldstein, Poole, Safko 2002, appendix A,
/// the "xyz" convention; their matrices are the transpose, from the laboratory to the body). Positive pitch lowers the
/// normal.
///
/// Source: (cos e cos a, cos e sin a, sin e) at azimuth a, elevation e. Detector with its arm at d and its plane tilted
/// by t: (cos d, sin d cos t, sin d sin t).
struct SampleTurns {
  Angle yaw{};
  Angle pitch{};
  Angle roll{};
  Angle detector{};
};

/// Theta in [0, 180 deg] by atan2 of the components across and along the normal, phi in (-180, 180] deg.
[[nodiscard]] Geometry directions_of(const TurningSample& sample, const SampleTurns& turns);

/// The angle between source and detector: it depends on the detector's arm alone.
[[nodiscard]] Angle separation_of(const TurningSample& sample, Angle detector);

/// How far the source stands outside of the plane of the detector's arm, in [-90, 90] deg: no phase angle is smaller.
[[nodiscard]] Angle source_out_of_plane(const TurningSample& sample);

/// Every set of turns that makes `g`, up to whole turns: two places of the detector's arm (one where they fall
/// together) times two ways over the pitch. What `g` leaves free is as near as can be to `standing`.
/// Errors: OutOfLimits (a phase angle that the arm cannot make: the source lies outside of its plane).
[[nodiscard]] Result<std::vector<SampleTurns>> turns_for(const TurningSample& sample, const Geometry& g,
                                                         const SampleTurns& standing);

}  // namespace gonio::drivers
