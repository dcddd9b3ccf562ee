#pragma once

#include "base/result.h"
#include "reflectance/direction/direction_pair.h"

namespace gonio::reflectance {

/// Directions as radiative transfer codes write them, SASKTRAN among them: the azimuth counts from where the light is
/// travelling to, so that 0 is forward (the mirror's side) and 180 deg is back towards the source: 180 deg less ours.
/// A table read with the wrong one of the two has its hot spot where the glint belongs.
struct ForwardAngles {
  Angle theta_i;           ///< zenith angle of the sun, 0 to 90 deg
  Angle theta_r;           ///< zenith angle of the view, 0 to 90 deg
  Angle relative_azimuth;  ///< phi_r - (phi_i + 180 deg), (-180, 180] deg; in the same sense as ours
  friend constexpr bool operator==(const ForwardAngles&, const ForwardAngles&) = default;
};

/// The azimuth is 180 deg at theta_r = 0 and counts from phi = 180 deg at theta_i = 0. phi_i is lost.
[[nodiscard]] ForwardAngles to_forward(const Direction& i, const Direction& r);

/// The pair with light from `phi_i`. Thetas 0 to 90 deg, azimuths finite. Errors: InvalidInput, naming the angle.
[[nodiscard]] Result<DirectionPair> from_forward(const ForwardAngles& angles, Angle phi_i = {});

}  // namespace gonio::reflectance
