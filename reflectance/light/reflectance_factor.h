#pragma once

#include <numbers>

#include "base/units.h"
#include "reflectance/direction/direction.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// Reflectances of one pair of directions, each f times a constant or a cosine. All are of the smooth part: a mirror
/// part has no value at a point. A bare "RADF" is not among them, since books disagree on what it is.

/// REFF, the reflectance factor: pi f, against a perfectly white Lambertian surface lit alike (Hapke 1993; Mobley
/// 2005).
[[nodiscard]] inline double reff(const Surface& surface, const Direction& i, const Direction& r) {
  return std::numbers::pi * in_per_steradian(surface.eval(i, r));
}

/// RADF as Mobley (2005) uses it: pi f for light from the normal.
[[nodiscard]] inline double radf_normal_incidence(const Surface& surface, const Direction& r) {
  return reff(surface, Direction(), r);
}

/// I/F, Hapke's (1993) radiance factor: pi f mu_i, against a white Lambertian surface lit from the normal.
[[nodiscard]] inline double i_over_f(const Surface& surface, const Direction& i, const Direction& r) {
  return reff(surface, i, r) * i.mu();
}

/// r, the bidirectional reflectance of Hapke and the radiance reflectance of Mobley (2005, eq 3): f mu_i [sr^-1].
[[nodiscard]] inline Brdf radiance_reflectance(const Surface& surface, const Direction& i, const Direction& r) {
  return surface.eval(i, r) * i.mu();
}

/// The normal albedo: pi f towards the source itself, at phase angle 0.
[[nodiscard]] inline double normal_albedo(const Surface& surface, const Direction& i) {
  return reff(surface, i, i);
}

}  // namespace gonio::reflectance
