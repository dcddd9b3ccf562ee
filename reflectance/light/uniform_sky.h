#pragma once

#include "base/result.h"
#include "reflectance/direction/direction.h"
#include "reflectance/light/brightness.h"

namespace gonio::reflectance {

/// The same radiance from all directions: isotropic light.
class UniformSky {
 public:
  /// `radiance` finite, at least 0 [W m^-2 sr^-1 or relative]. Errors: InvalidInput.
  [[nodiscard]] static Result<UniformSky> make(double radiance) {
    GONIO_TRY(check_brightness("uniform sky", "radiance", radiance));
    return UniformSky(radiance);
  }

  [[nodiscard]] double radiance(const Direction&) const { return radiance_; }
  [[nodiscard]] bool is_zonal() const { return true; }

 private:
  explicit UniformSky(double radiance) : radiance_(radiance) {}
  double radiance_;
};

}  // namespace gonio::reflectance
