#pragma once

#include "base/result.h"
#include "reflectance/direction/direction_pair.h"

namespace gonio::reflectance {

/// The half and difference angles of Rusinkiewicz (1998), "A New Change of Variables for Efficient BRDF
/// Representation": h halves the arc from i to r; theta_d, phi_d are where i lies once h has been turned by -phi_h
/// about the normal and by -theta_h into it. phi_d is 0 where i lies farther from the normal than h, in its plane.
/// Specular is theta_h = 0, retro-reflection theta_d = 0; exchanging i and r adds 180 deg to phi_d; an isotropic
/// surface does not know phi_h.
/// Where an azimuth means nothing: phi_h = 0 at theta_h = 0, and phi_d is phi_i there; phi_d = 0 at theta_d = 0; two
/// opposite directions along the horizon have theta_h = 0, theta_d = 90 deg, phi_d = phi_i.
struct RusinkiewiczAngles {
  Angle theta_h;  ///< 0 to 90 deg
  Angle phi_h;    ///< (-180, 180] deg
  Angle theta_d;  ///< 0 to 90 deg: half of the phase angle
  Angle phi_d;    ///< (-180, 180] deg
  friend constexpr bool operator==(const RusinkiewiczAngles&, const RusinkiewiczAngles&) = default;
};

/// All products and sums of like signs, so that theta_h at 1e-12 rad from specular and theta_d at 1e-12 rad from retro
/// keep the digits that i and r have: each theta to some 1e-15 relative, each phi to some 1e-15 rad.
[[nodiscard]] RusinkiewiczAngles to_rusinkiewicz(const Direction& i, const Direction& r);

/// The pair with these angles, each direction to some 2e-16 rad; so theta_d comes back to 4e-16 rad absolute, phi_d to
/// that over theta_d. Thetas 0 to 90 deg, phis finite. Errors: InvalidInput, also when i or r would lie below the
/// horizon.
[[nodiscard]] Result<DirectionPair> from_rusinkiewicz(const RusinkiewiczAngles& angles);

}  // namespace gonio::reflectance
