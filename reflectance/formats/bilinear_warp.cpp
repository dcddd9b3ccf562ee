#include "reflectance/formats/bilinear_warp.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace gonio::formats {
namespace {

// Where between two nodes, 0 to 1, a density that goes evenly from a to b has gathered `area`, at most (a + b)/2: the
// root of a t + (b - a) t^2/2 = area in the form that does not cancel.
double gathered_at(double a, double b, double area) {
  const double root = std::sqrt(std::max(0.0, a * a + 2.0 * (b - a) * area));
  const double sum = a + root;
  return sum > 0.0 ? std::clamp(2.0 * area / sum, 0.0, 1.0) : 0.0;
}

struct Cell {
  std::size_t index;
  double share;
};

Cell cell_of(double x, std::size_t nodes) {
  const double scaled = std::clamp(x, 0.0, 1.0) * static_cast<double>(nodes - 1);
  const std::size_t index = std::min(static_cast<std::size_t>(scaled), nodes - 2);
  return {.index = index, .share = scaled - static_cast<double>(index)};
}

}  // namespace

BilinearWarp::BilinearWarp(std::size_t rows, std::size_t columns, std::span<const double> values)
    : rows_(rows), columns_(columns), values_(values.begin(), values.end()), row_sums_(values.size()) {
  assert(rows >= 2 && columns >= 2 && values.size() == rows * columns);
  marginal_sums_.push_back(0.0);
  for (std::size_t row = 0; row < rows_; ++row) {
    for (std::size_t column = 1; column < columns_; ++column)
      row_sums_[row * columns_ + column] =
          row_sums_[row * columns_ + column - 1] + 0.5 * (value(row, column - 1) + value(row, column));
    if (row == 0) continue;
    const double between = row_sums_[row * columns_ - 1] + row_sums_[(row + 1) * columns_ - 1];
    marginal_sums_.push_back(marginal_sums_.back() + 0.5 * between);
  }
}

double BilinearWarp::at(SquarePoint point) const {
  const Cell column = cell_of(point.u, columns_);
  const Cell row = cell_of(point.v, rows_);
  const double low = std::lerp(value(row.index, column.index), value(row.index, column.index + 1), column.share);
  const double high =
      std::lerp(value(row.index + 1, column.index), value(row.index + 1, column.index + 1), column.share);
  return std::lerp(low, high, row.share);
}

SquarePoint BilinearWarp::warped(SquarePoint even) const {
  const double up_to = even.v * marginal_sums_.back();
  const auto after = std::upper_bound(marginal_sums_.begin() + 1, marginal_sums_.end() - 1, up_to);
  const auto row = static_cast<std::size_t>(after - marginal_sums_.begin()) - 1;
  const double low_total = row_sums_[(row + 1) * columns_ - 1];
  const double high_total = row_sums_[(row + 2) * columns_ - 1];
  const double v = gathered_at(low_total, high_total, up_to - marginal_sums_[row]);

  const auto sum_to = [&](std::size_t column) {
    return std::lerp(row_sums_[row * columns_ + column], row_sums_[(row + 1) * columns_ + column], v);
  };
  const double along = even.u * sum_to(columns_ - 1);
  std::size_t column = 0;
  for (std::size_t width = columns_ - 1; width > 1;) {
    const std::size_t half = width / 2;
    if (sum_to(column + half) <= along) {
      column += half;
      width -= half;
    } else {
      width = half;
    }
  }
  const double left = std::lerp(value(row, column), value(row + 1, column), v);
  const double right = std::lerp(value(row, column + 1), value(row + 1, column + 1), v);
  const double u = gathered_at(left, right, along - sum_to(column));
  return {.u = (static_cast<double>(column) + u) / static_cast<double>(columns_ - 1),
          .v = (static_cast<double>(row) + v) / static_cast<double>(rows_ - 1)};
}

}  // namespace gonio::formats
