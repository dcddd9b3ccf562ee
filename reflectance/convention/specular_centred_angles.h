#pragma once

#include "base/result.h"
#include "reflectance/direction/direction_pair.h"

namespace gonio::reflectance {

/// r as seen from the mirror direction of i: the arc between them, which ASTM E2387 calls the aspecular angle, and the
/// azimuth about it, 0 towards the normal and counter-clockwise seen from outside, as in the BSDF interchange format of
/// Radiant Imaging and Zemax (2008). Light in the mirror direction has radial 0, retro-reflection radial 2 theta_i
/// at azimuth 0, light that leaves flatter than the mirror's azimuth 180 deg.
/// Where the azimuth means nothing: 0 at radial 0. At normal incidence it counts from phi = 0, as phi_r does.
struct SpecularCentredAngles {
  Angle theta_i;  ///< 0 to 90 deg
  Angle phi_i;    ///< (-180, 180] deg
  Angle radial;   ///< 0 to 180 deg
  Angle azimuth;  ///< (-180, 180] deg
  friend constexpr bool operator==(const SpecularCentredAngles&, const SpecularCentredAngles&) = default;
};

/// Stable as `to_rusinkiewicz` is: a radial of 1e-12 rad keeps the digits that i and r have.
[[nodiscard]] SpecularCentredAngles to_specular_centred(const Direction& i, const Direction& r);

/// r to some 2e-16 rad. theta_i 0 to 90 deg, radial 0 to 180 deg, azimuths finite. Errors: InvalidInput, also when r
/// would lie below the horizon.
[[nodiscard]] Result<DirectionPair> from_specular_centred(const SpecularCentredAngles& angles);

}  // namespace gonio::reflectance
