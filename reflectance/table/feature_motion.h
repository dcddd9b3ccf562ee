#pragma once

#include <algorithm>
#include <cmath>

#include "reflectance/direction/direction.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// The zenith angle of an incidence as it enters the formulas.
struct IncidenceTilt {
  double mu = 1.0;
  double sin_theta = 0.0;
};

/// How far the horizon is from the direction (sin_theta, 0, mu) along an azimuth psi about it, psi = 0 towards the
/// normal [rad].
[[nodiscard]] inline double arc_to_horizon(const IncidenceTilt& axis, double cos_psi) {
  constexpr double kLeast = 1e-12;
  return std::max(kLeast, std::atan2(axis.mu, -axis.sin_theta * cos_psi));
}

/// The direction that is to a feature under incidence `to` what `r` is to it under `from`, both in the frame of their
/// incidence. Polar coordinates about the feature, retro-reflection or the mirror direction: the azimuth psi stays, and
/// so does 1/xi - 1/L of the arc xi and the arc L to the horizon. Hence shapes close to the feature keep their size,
/// the horizon stays the horizon, and `to` and `from` changed over undo it. Without a feature, r itself. `stretch`,
/// when asked for, receives dOmega(result) / dOmega(r).
[[nodiscard]] inline Vector moved(const Vector& r, const IncidenceTilt& from, const IncidenceTilt& to, Feature feature,
                                  double* stretch = nullptr) {
  if (stretch != nullptr) *stretch = 1.0;
  if (feature == Feature::Smooth || (from.mu == to.mu && from.sin_theta == to.sin_theta)) return r;
  const double side = feature == Feature::HotSpot ? 1.0 : -1.0;
  const double x = side * r.x;
  const double sin_cos_psi = r.z * from.sin_theta - x * from.mu;  // sin(xi) cos(psi)
  const double sin_xi = std::hypot(sin_cos_psi, r.y);
  const double cos_psi = sin_xi > 0.0 ? sin_cos_psi / sin_xi : 1.0;
  const double sin_psi = sin_xi > 0.0 ? r.y / sin_xi : 0.0;
  const double length = arc_to_horizon(from, cos_psi);
  const double new_length = arc_to_horizon(to, cos_psi);
  const double xi = std::clamp(std::atan2(sin_xi, x * from.sin_theta + r.z * from.mu), 1e-300, length);
  const double new_xi = 1.0 / (1.0 / xi + (1.0 / new_length - 1.0 / length));
  const double s = std::sin(new_xi);
  const double c = std::cos(new_xi);
  if (stretch != nullptr) {
    const double ratio = new_xi / xi;
    *stretch = ratio * ratio * (xi > 1e-6 ? s / std::sin(xi) : ratio);
  }
  return {.x = side * (c * to.sin_theta - s * cos_psi * to.mu),
          .y = s * sin_psi,
          .z = std::max(0.0, c * to.mu + s * cos_psi * to.sin_theta)};
}

/// Where two features move at once, the retro direction's and the mirror's: how much `r` belongs to the first, by the
/// fourth powers of its distances to the two. 0 to 1.
[[nodiscard]] inline double retro_share(const Vector& r, const IncidenceTilt& i) {
  const double aside2 = r.y * r.y + (r.z - i.mu) * (r.z - i.mu);
  const double to_retro2 = (r.x - i.sin_theta) * (r.x - i.sin_theta) + aside2;
  const double to_mirror2 = (r.x + i.sin_theta) * (r.x + i.sin_theta) + aside2;
  const double retro4 = to_retro2 * to_retro2;
  const double mirror4 = to_mirror2 * to_mirror2;
  return retro4 + mirror4 > 0.0 ? mirror4 / (retro4 + mirror4) : 0.5;
}

}  // namespace gonio::reflectance
