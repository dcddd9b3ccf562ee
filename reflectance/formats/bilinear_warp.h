#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace gonio::formats {

/// A point of the unit square: u along the last index of a table, v along the one before.
struct SquarePoint {
  double u = 0.0;
  double v = 0.0;
};

/// A table over the unit square, nodes at k/(n-1) along each side, bilinear between them: its value at a point, and the
/// warp that spreads even points as the table is dense: v by the marginal density of rows, then u within them.
class BilinearWarp {
 public:
  /// rows x columns values, at least 2 x 2 (asserted), none negative, not all 0 where `warped` is to be asked.
  BilinearWarp(std::size_t rows, std::size_t columns, std::span<const double> values);

  [[nodiscard]] double at(SquarePoint point) const;
  /// Where an even point of the square goes to.
  [[nodiscard]] SquarePoint warped(SquarePoint even) const;

 private:
  [[nodiscard]] double value(std::size_t row, std::size_t column) const { return values_[row * columns_ + column]; }
  std::size_t rows_;
  std::size_t columns_;
  std::vector<double> values_;
  std::vector<double> row_sums_;       ///< up to a node along its row, trapezoids of width 1; as `values_`
  std::vector<double> marginal_sums_;  ///< up to a row, by the rows' totals
};

}  // namespace gonio::formats
