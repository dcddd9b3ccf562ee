#pragma once

#include "base/result.h"
#include "reflectance/direction/direction_pair.h"

namespace gonio::reflectance {

/// Directions as Hapke (1981, 1993) writes them. Beware of his letters: his g is our phase angle xi, his xi our
/// asymmetry parameter g, his psi an azimuth where Mobley has the scattering angle, his w our omega0.
/// His surfaces know neither a turn nor a mirror image, so he needs no phi_i and psi in 0 to 180 deg alone; here psi
/// keeps the sign of phi_r - phi_i.
struct HapkeAngles {
  Angle i;    ///< incidence, our theta_i: 0 to 90 deg
  Angle e;    ///< emergence, our theta_r: 0 to 90 deg
  Angle psi;  ///< azimuth between the planes of incidence and emergence, 0 towards the source: (-180, 180] deg
  Angle g;    ///< phase angle, our xi: 0 to 180 deg
  friend constexpr bool operator==(const HapkeAngles&, const HapkeAngles&) = default;
};

/// psi is 0 at e = 0 and counts from phi = 0 at i = 0. phi_i is lost.
[[nodiscard]] HapkeAngles to_hapke(const Direction& i, const Direction& r);

/// The pair with light from `phi_i`. g says what i, e and psi say already: Errors: InvalidInput when an angle is out
/// of its range or g differs from theirs by more than `tolerance` (half a unit of the last digit of a printed table).
[[nodiscard]] Result<DirectionPair> from_hapke(const HapkeAngles& angles, Angle phi_i = {},
                                               Angle tolerance = degrees(1e-6));

/// The psi in 0 to 180 deg that tables of (i, e, g) leave out, by the half-angle formula
///   tan^2(psi/2) = sin((g + i - e)/2) sin((g - i + e)/2) / (sin((i + e + g)/2) sin((i + e - g)/2));
/// 0 at i = 0 or e = 0. Errors: InvalidInput when an angle is out of its range or no azimuth makes this g: |i - e| <= g
/// <= i + e, to 1e-15 rad.
[[nodiscard]] Result<HapkeAngles> hapke_from_phase(Angle i, Angle e, Angle g);

}  // namespace gonio::reflectance
