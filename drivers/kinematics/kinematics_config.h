#pragma once

#include <cstdint>

#include "base/units.h"
#include "protocol/stage/axis.h"

namespace gonio::drivers {

/// How axes make directions. Names in files: "arms", "turning-sample".
enum class KinematicsKind : std::uint8_t {
  Arms,           ///< each axis is the angle of its name: theta_i, phi_i, theta_r, phi_r
  TurningSample,  ///< the source stands still, the sample turns (yaw, pitch, roll), the detector is on an arm
};

/// A stage whose source stands still. Which of the stage's axes turns what, and how the fixed parts stand in the
/// laboratory; the convention is in `turning_sample.h`. The four axes differ, and have degrees as their unit.
struct TurningSample {
  stage::Axis yaw = stage::Axis::ThetaI;
  stage::Axis pitch = stage::Axis::PhiI;
  stage::Axis roll = stage::Axis::PhiR;
  stage::Axis detector_arm = stage::Axis::ThetaR;
  Angle source_azimuth{};       ///< in the laboratory's horizontal plane, from x towards y
  Angle source_elevation{};     ///< above that plane
  Angle detector_plane_tilt{};  ///< of the plane in which the detector's arm turns, about x, from y towards z
};

struct KinematicsConfig {
  KinematicsKind kind = KinematicsKind::Arms;
  TurningSample turning{};  ///< read by TurningSample only
};

}  // namespace gonio::drivers
