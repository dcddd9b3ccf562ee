#pragma once

#include "base/geometry.h"
#include "sim/scene/turning_sample_spec.h"

namespace gonio::sim {

/// How far a turning sample and its detector's arm are turned.
struct SampleTurn {
  Angle yaw;
  Angle pitch;
  Angle roll;
  Angle detector_arm;
};

/// The directions on a turning sample, by unit quaternions. At zero the sample's normal lies along the laboratory's x,
/// its azimuth 0 along y and 90 deg along z (up). It is rolled about its normal, then pitched about the laboratory's y,
/// then yawed about z, all right-handed: the same as yaw, pitch and roll about its own axes, q = q_z(yaw) q_y(pitch)
/// q_x(roll) (Diebel 2006, section on Euler angles (1,2,3)). The source lies at its azimuth (x towards y) and
/// elevation; the arm turns in the plane of x and y, which is tilted about x.
[[nodiscard]] Geometry directions_on(const TurningSampleSpec& sample, const SampleTurn& turn);

}  // namespace gonio::sim
