#include "reflectance/light/beam.h"

#include "reflectance/light/brightness.h"

namespace gonio::reflectance {

Result<Beam> Beam::make(const Direction& direction, double normal_irradiance) {
  GONIO_TRY(check_brightness("beam", "normal_irradiance", normal_irradiance));
  return Beam(direction, normal_irradiance);
}

}  // namespace gonio::reflectance
