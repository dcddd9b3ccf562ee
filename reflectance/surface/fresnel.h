#pragma once

#include "base/units.h"

namespace gonio::reflectance {

/// The share of light that a flat interface reflects, for each polarisation.
struct FresnelReflectance {
  double s = 0.0;  ///< across the plane of incidence
  double p = 0.0;  ///< in the plane of incidence
  [[nodiscard]] constexpr double unpolarised() const { return 0.5 * (s + p); }
};

/// Fresnel's reflectances of a clear, flat interface; `n` is the index of the far side over that of the side the light
/// comes from: 1.34 from air into water, 1/1.34 from water into air. n > 0, finite (asserted). In the cosine form
///   r_s = (1 - n^2) / (c + n t)^2,  r_p = (n^2 - 1)(c^2 - s^2/n^2) / (n c + t)^2,  t^2 = 1 - s^2/n^2,
/// t the cosine of the refracted angle, whose numerators do not cancel, at normal incidence and n near 1 included.
/// Total reflection is 1 exactly. `cos_theta`, `sin_theta` of the angle of incidence, in [0, 1].
[[nodiscard]] FresnelReflectance fresnel(double cos_theta, double sin_theta, double n);
/// As above, theta in [0, 90 deg] (asserted); t^2 from sin(tc - theta) sin(tc + theta) towards the critical angle tc.
[[nodiscard]] FresnelReflectance fresnel(Angle theta, double n);

/// What passes, unpolarised: 1 - R without the subtraction, so that it keeps its digits towards the horizon and the
/// critical angle. 0 in total reflection. Arguments as above; at cos_theta = 0 with n = 1 it is 0, as for any n.
[[nodiscard]] double fresnel_transmittance(double cos_theta, double sin_theta, double n);

/// The unpolarised reflectance for light from all directions alike, 2 integral of R mu dmu, to 1e-15 absolute. From the
/// denser side it follows from the other: 1 - (1 - A)/n^2 (Walsh 1926, Duntley 1942).
[[nodiscard]] double fresnel_albedo(double n);

}  // namespace gonio::reflectance
