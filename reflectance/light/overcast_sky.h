#pragma once

#include "base/result.h"
#include "reflectance/direction/direction.h"
#include "reflectance/light/brightness.h"

namespace gonio::reflectance {

/// A heavily overcast sky, three times as bright at the zenith as at the horizon: L = L_z (1 + 2 cos theta)/3 (Moon and
/// Spencer 1942), also called cardioidal. E_d = 7 pi L_z / 9.
class OvercastSky {
 public:
  /// `zenith_radiance` finite, at least 0 [W m^-2 sr^-1 or relative]. Errors: InvalidInput.
  [[nodiscard]] static Result<OvercastSky> make(double zenith_radiance) {
    GONIO_TRY(check_brightness("overcast sky", "zenith_radiance", zenith_radiance));
    return OvercastSky(zenith_radiance);
  }

  [[nodiscard]] double radiance(const Direction& i) const { return zenith_radiance_ * (1.0 + 2.0 * i.mu()) / 3.0; }
  [[nodiscard]] bool is_zonal() const { return true; }

 private:
  explicit OvercastSky(double zenith_radiance) : zenith_radiance_(zenith_radiance) {}
  double zenith_radiance_;
};

}  // namespace gonio::reflectance
