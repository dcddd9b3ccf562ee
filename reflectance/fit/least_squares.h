#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "base/result.h"

namespace gonio::fit {

/// A sum of squares to be made small over x in [0, 1]^p.
struct LeastSquares {
  std::size_t residuals = 0;
  std::size_t parameters = 0;
  /// Fills `residuals` numbers, and unless it is empty their slopes, row by row: residuals x parameters. False where
  /// the numbers are not finite: the step is taken back.
  std::function<bool(std::span<const double> x, std::span<double> r, std::span<double> slopes)> evaluate;
};

struct LeastSquaresMinimum {
  std::vector<double> x;
  double sum_of_squares = 0.0;
  int iterations = 0;
  bool has_converged = false;  ///< else the bound of iterations came first
};

/// Levenberg and Marquardt's method within the bounds, from `start`. Errors: InvalidInput where not even the start can
/// be evaluated.
[[nodiscard]] Result<LeastSquaresMinimum> minimise(const LeastSquares& problem, std::vector<double> start,
                                                   int most_iterations);

}  // namespace gonio::fit
