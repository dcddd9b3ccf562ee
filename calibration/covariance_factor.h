#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace gonio::calibration {

/// The lower triangle L, row by row, of an n x n covariance C = L L^T (Cholesky): column j is what one standard
/// deviation of the j-th of n independent errors does to each of the n quantities. A pivot that is not above rounding
/// gives a column of zeros: a quantity that the others fix.
[[nodiscard]] inline std::vector<double> covariance_factor(std::span<const double> c, std::size_t n) {
  constexpr double kRounding = 1e-12;
  std::vector<double> factor(n * n, 0.0);
  for (std::size_t j = 0; j < n; ++j) {
    double pivot = c[j * n + j];
    for (std::size_t k = 0; k < j; ++k) pivot -= factor[j * n + k] * factor[j * n + k];
    if (!(pivot > kRounding * c[j * n + j])) continue;
    factor[j * n + j] = std::sqrt(pivot);
    for (std::size_t i = j + 1; i < n; ++i) {
      double sum = c[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= factor[i * n + k] * factor[j * n + k];
      factor[i * n + j] = sum / factor[j * n + j];
    }
  }
  return factor;
}

}  // namespace gonio::calibration
