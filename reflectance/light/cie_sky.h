#pragma once

#include <optional>

#include "base/result.h"
#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// The skies of CIE S 011/E:2003 (ISO 15469:2004), from overcast (1) to cloudless and turbid (15); 12 is the CIE clear
/// sky. Relative to the zenith
///   L/L_z = phi(theta) f(chi) / (phi(0) f(theta_s)),
///   phi = 1 + a exp(b / cos theta),  f = 1 + c (exp(d chi) - exp(d pi/2)) + e cos^2 chi,
/// chi the arc from the sun, which stands at theta_s. The sky without the sun itself: add a SunDisk.
class CieSky {
 public:
  /// `type` 1 to 15; `zenith_radiance` finite, at least 0 [W m^-2 sr^-1 or relative]. Errors: InvalidInput.
  [[nodiscard]] static Result<CieSky> make(int type, const Direction& sun, double zenith_radiance);

  [[nodiscard]] double radiance(const Direction& i) const;
  /// Types 1, 3 and 5 do not know where the sun is.
  [[nodiscard]] bool is_zonal() const { return p_.c == 0.0 && p_.e == 0.0; }
  [[nodiscard]] std::optional<Direction> peak() const { return is_zonal() ? std::nullopt : std::optional(sun_); }

 private:
  struct Parameters {
    double a, b, c, d, e;
  };
  static const Parameters kTypes[15];

  CieSky(const Parameters& p, const Direction& sun, double zenith_radiance);
  [[nodiscard]] double gradation(double mu) const;
  [[nodiscard]] double indicatrix(double chi) const;

  Parameters p_;
  Direction sun_;
  double scale_;  ///< L_z / (phi(0) f(theta_s))
};

}  // namespace gonio::reflectance
