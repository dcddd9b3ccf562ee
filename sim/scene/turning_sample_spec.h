#pragma once

#include "base/units.h"
#include "protocol/stage/axis.h"

namespace gonio::sim {

/// A stage whose source stands still before a sample that turns, with the detector on an arm: which axis turns what,
/// and how the fixed parts stand. In the scene's file: [stage.kinematics] with the same keys as in instrument.toml.
struct TurningSampleSpec {
  stage::Axis yaw = stage::Axis::ThetaI;
  stage::Axis pitch = stage::Axis::PhiI;
  stage::Axis roll = stage::Axis::PhiR;
  stage::Axis detector_arm = stage::Axis::ThetaR;
  Angle source_azimuth;
  Angle source_elevation;
  Angle detector_plane_tilt;
};

}  // namespace gonio::sim
