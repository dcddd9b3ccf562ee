#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/result.h"

namespace gonio::calibration {

/// A sum of squares to be made least, built from rows  r = sum_k j_k dp_k  of standard deviation 1 (each divided by its
/// own), as its normal equations: one symmetric matrix, so that any number of rows takes the same memory.
class LeastSquares {
 public:
  explicit LeastSquares(std::size_t parameters);

  /// One row: what is left to explain, and its derivatives by the parameters that it depends on, both over its standard
  /// deviation. `places` and `slopes` have the same size.
  void add(double residual, std::span<const std::size_t> places, std::span<const double> slopes);

  struct Step {
    std::vector<double> change;      ///< of the parameters
    std::vector<double> covariance;  ///< row by row
  };
  /// Errors: IncompleteData (the rows leave a combination of the parameters open).
  [[nodiscard]] Result<Step> solve() const;

  [[nodiscard]] double sum_of_squares() const { return squares_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }

 private:
  std::size_t n_;
  std::vector<double> matrix_;  ///< J^T J
  std::vector<double> right_;   ///< J^T r
  double squares_ = 0.0;
  std::size_t rows_ = 0;
};

}  // namespace gonio::calibration
