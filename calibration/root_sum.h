#pragma once

#include <cmath>

namespace gonio::calibration {

/// sqrt(a^2 + b^2) of uncertainties, which are far from the ends of a double's range: std::hypot guards those, at ten
/// times the price.
[[nodiscard]] inline double root_sum(double a, double b) {
  return std::sqrt(a * a + b * b);
}

}  // namespace gonio::calibration
