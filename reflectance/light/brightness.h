#pragma once

#include <cmath>
#include <string>
#include <string_view>

#include "base/result.h"

namespace gonio::reflectance {

/// What every brightness of a light has to be, be it a radiance or an irradiance.
[[nodiscard]] inline bool is_brightness(double value) {
  return std::isfinite(value) && value >= 0.0;
}

/// Errors: InvalidInput with the field's name and value.
[[nodiscard]] Result<void> check_brightness(std::string_view light, std::string_view field, double value);

}  // namespace gonio::reflectance
