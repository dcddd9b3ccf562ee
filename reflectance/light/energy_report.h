#pragma once

#include <cstdint>
#include <vector>

#include "base/units.h"
#include "reflectance/integral/integral.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// A range of incidences from which a surface sends back more than it gets.
struct EnergyExcess {
  Angle phi_i;
  Angle from_theta_i;  ///< where rho_dh passes 1, or 0 deg where it begins above
  Angle to_theta_i;    ///< likewise, or 90 deg
  Angle worst_theta_i;
  Integral worst;  ///< rho_dh there, the largest of those looked at
};

struct EnergyReport {
  std::vector<EnergyExcess> excesses;  ///< by phi_i, then theta_i; empty for a surface that keeps energy
  std::uint64_t evaluations = 0;
  [[nodiscard]] bool keeps_energy() const { return excesses.empty(); }
};

/// Looks at rho_dh from the normal to 89.9999 deg, at every 5 deg and closer towards the horizon, at phi_i = 0, for an
/// anisotropic surface at every 30 deg of it, and reports where it exceeds 1 by more than its own error. Where it
/// passes 1 is found to some `edge` of theta_i, or to where the error of rho_dh (asked for to 1e-12) leaves it open. An
/// excess between two neighbours looked at is not seen. Nothing is clipped.
[[nodiscard]] EnergyReport energy_report(const Surface& surface, Angle edge = degrees(1e-6));

}  // namespace gonio::reflectance
