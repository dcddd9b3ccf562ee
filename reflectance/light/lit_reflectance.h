#pragma once

#include <cstdint>

#include "base/result.h"
#include "reflectance/integral/integral.h"
#include "reflectance/light/light.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// An integral over incident light, and what it shows of the surface that no real one does. Nothing is clipped.
struct LitIntegral {
  double value = 0.0;
  double error = 0.0;              ///< estimate of |value - truth|, meant as an upper bound, as in Integral
  std::uint64_t evaluations = 0;   ///< of BRDF and radiance; 0 for a closed form
  bool is_above_one = false;       ///< a reflectance, beyond its error: the model gives back more than it gets
  bool has_negative_brdf = false;  ///< f < 0 was met on the way
  [[nodiscard]] bool is_physical() const { return !is_above_one && !has_negative_brdf; }
};

// Errors of all functions below: InvalidInput where a radiance is negative or not finite (names the direction), or f is
// not finite (names both); of the ratios also where E_d is 0. `relative_tolerance` is at least 1e-12; where the work's
// bound is reached first, `error` says so.

/// E_d = integral of L_i mu_i dOmega_i, in the light's unit x sr.
[[nodiscard]] Result<LitIntegral> downwelling_irradiance(const Light& light, double relative_tolerance = 1e-9);

/// E_u = integral of rho_dh(i) L_i mu_i dOmega_i: all that the surface sends up, mirror part included; unit of E_d.
[[nodiscard]] Result<LitIntegral> upwelling_irradiance(const Surface& surface, const Light& light,
                                                       double relative_tolerance = 1e-6);

/// R = E_u / E_d, the irradiance reflectance or albedo under this light (Mobley 2005, eq 6). rho for a Lambertian
/// surface, rho_dh under a beam, A under a uniform sky.
[[nodiscard]] Result<LitIntegral> hemispherical_reflectance(const Surface& surface, const Light& light,
                                                            double relative_tolerance = 1e-6);

/// L_r(r) = integral of L_i f mu_i dOmega_i (Mobley 2005, eq 3), in the light's unit; the mirror part adds R_F L_i of
/// the direction that is mirrored into r, exactly (eq 9). A further error, InvalidInput: a beam that the mirror part
/// sends into r itself, where the radiance is a delta.
[[nodiscard]] Result<LitIntegral> reflected_radiance(const Surface& surface, const Light& light, const Direction& r,
                                                     double relative_tolerance = 1e-6);

/// R_rs(r) = L_r(r) / E_d [sr^-1], the remote-sensing reflectance of all that leaves; of the water alone when `surface`
/// is the water_leaving_part.
[[nodiscard]] Result<LitIntegral> remote_sensing_reflectance(const Surface& surface, const Light& light,
                                                             const Direction& r, double relative_tolerance = 1e-6);

/// What of `surface` sends up light from below the water: a WaterBody, or those in a sum with their weights; without
/// the mirror and the glint of the water's surface. Errors: InvalidInput where there is none.
[[nodiscard]] Result<Surface> water_leaving_part(const Surface& surface);

}  // namespace gonio::reflectance
