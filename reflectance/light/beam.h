#pragma once

#include "base/result.h"
#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// Collimated light: a delta in radiance, which carries irradiance. The limit of a sun disk of radius 0.
class Beam {
 public:
  /// `direction` is where it comes from; `normal_irradiance` what falls on a plane across the beam, finite, at least 0
  /// [W m^-2 or relative]. Errors: InvalidInput.
  [[nodiscard]] static Result<Beam> make(const Direction& direction, double normal_irradiance);

  [[nodiscard]] const Direction& direction() const { return direction_; }
  [[nodiscard]] double normal_irradiance() const { return normal_irradiance_; }
  /// On the horizontal surface: E_n mu.
  [[nodiscard]] double irradiance() const { return normal_irradiance_ * direction_.mu(); }

 private:
  Beam(const Direction& direction, double normal_irradiance)
      : direction_(direction), normal_irradiance_(normal_irradiance) {}
  Direction direction_;
  double normal_irradiance_;
};

}  // namespace gonio::reflectance
