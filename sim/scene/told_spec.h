#pragma once

#include <optional>

#include "base/units.h"

namespace gonio::sim {

/// What the daemon is told of the instrument where that is not what the simulator itself works with: an effect that is
/// fixed rather than drawn has no uncertainty of its own. Scene time.
struct ToldSpec {
  std::optional<double> u_linearity;
  double exposure_offset_s = 0.0;
  double u_exposure_offset_s = 0.0;
  double u_dark_drift_dn_per_s = 0.0;
  std::optional<Angle> u_zero_theta_i;
  std::optional<Angle> u_zero_theta_r;
  std::optional<Angle> u_zero_phi_r;
  std::optional<Angle> u_repeat;
  std::optional<double> u_after_monitor;
  std::optional<double> u_reproducibility;
  Angle source_half_cone = degrees(0.5);
  Angle detector_half_cone = degrees(0.5);
};

}  // namespace gonio::sim
