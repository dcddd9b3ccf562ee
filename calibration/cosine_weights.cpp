#include "calibration/cosine_weights.h"

#include <cmath>
#include <cstddef>

namespace gonio::calibration {

std::vector<double> cosine_weights(const std::vector<Angle>& grid) {
  const auto m0 = [](double t) { return -0.25 * std::cos(2.0 * t); };
  const auto m1 = [](double t) { return 0.125 * std::sin(2.0 * t) - 0.25 * t * std::cos(2.0 * t); };
  std::vector<double> weights(grid.size(), 0.0);
  for (std::size_t k = 0; k + 1 < grid.size(); ++k) {
    const double a = grid[k].si();
    const double b = grid[k + 1].si();
    const double zeroth = m0(b) - m0(a);
    const double first = m1(b) - m1(a);
    weights[k] += (b * zeroth - first) / (b - a);
    weights[k + 1] += (first - a * zeroth) / (b - a);
  }
  return weights;
}

}  // namespace gonio::calibration
