#pragma once

#include "base/result.h"
#include "reflectance/direction/direction_pair.h"

namespace gonio::reflectance {

/// Directions as NBS Monograph 160 (Nicodemus et al. 1977) writes them: ours, but for azimuths that run from 0 to 360
/// deg. Both point away from the surface, so retro-reflection has phi_r = phi_i.
struct Nbs160Angles {
  Angle theta_i;  ///< 0 to 90 deg
  Angle phi_i;    ///< [0, 360) deg, 0 at the pole
  Angle theta_r;  ///< 0 to 90 deg
  Angle phi_r;    ///< [0, 360) deg, 0 at the pole
  friend constexpr bool operator==(const Nbs160Angles&, const Nbs160Angles&) = default;
};

[[nodiscard]] Nbs160Angles to_nbs160(const Direction& i, const Direction& r);

/// Thetas 0 to 90 deg, phis finite. Errors: InvalidInput, naming the angle.
[[nodiscard]] Result<DirectionPair> from_nbs160(const Nbs160Angles& angles);

}  // namespace gonio::reflectance
