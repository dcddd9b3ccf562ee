#pragma once

#include "base/units.h"

namespace gonio {

/// The directions of one reading. Both point away from the surface: `i` to the source, `r` to the detector; theta from
/// the normal, phi counter-clockwise seen from above (NBS Monograph 160; Mobley 2005).
/// Retro-reflection: (theta_r, phi_r) = (theta_i, phi_i). Specular: (theta_i, phi_i + 180 deg).
struct Geometry {
  Angle theta_i;
  Angle phi_i;
  Angle theta_r;
  Angle phi_r;
  friend constexpr bool operator==(const Geometry&, const Geometry&) = default;
};

/// The same angle in (-180, 180] deg.
[[nodiscard]] Angle wrapped(Angle a);

/// The phase angle xi between the two directions, in [0, 180 deg].
/// xi = 2 atan2(sqrt(s2), sqrt(c2)) with s2 = sin^2((ti-tr)/2) + sin ti sin tr sin^2(dphi/2) and c2 likewise: keeps
/// all digits near retro and near 180 deg, where acos(cos xi) loses them (Kahan's half-angle form).
[[nodiscard]] Angle phase_angle(const Geometry& g);

/// Two directions at the same point of the hemisphere: equal theta and, off the pole, equal phi modulo 360 deg,
/// within `tolerance` of arc. For an isotropic sample only phi_r - phi_i counts, and at theta_i = 0 neither does.
[[nodiscard]] bool same_geometry(const Geometry& a, const Geometry& b, bool isotropic, Angle tolerance);

}  // namespace gonio
