#include "calibration/jobs/least_squares.h"

#include <fmt/format.h>

#include <cmath>

namespace gonio::calibration {

namespace {

// What is left of a diagonal element after the rows above, relative: below this the parameter is not told.
constexpr double kOpen = 1e-13;

}  // namespace

LeastSquares::LeastSquares(std::size_t parameters) : n_(parameters), matrix_(n_ * n_, 0.0), right_(n_, 0.0) {}

void LeastSquares::add(double residual, std::span<const std::size_t> places, std::span<const double> slopes) {
  for (std::size_t a = 0; a < places.size(); ++a) {
    right_[places[a]] += slopes[a] * residual;
    for (std::size_t b = 0; b < places.size(); ++b) matrix_[places[a] * n_ + places[b]] += slopes[a] * slopes[b];
  }
  squares_ += residual * residual;
  ++rows_;
}

// By Cholesky's factor L of the matrix scaled to a unit diagonal: the parameters' units may differ by any power.
Result<LeastSquares::Step> LeastSquares::solve() const {
  std::vector<double> scale(n_, 1.0);
  for (std::size_t i = 0; i < n_; ++i) {
    if (matrix_[i * n_ + i] > 0.0) scale[i] = 1.0 / std::sqrt(matrix_[i * n_ + i]);
  }
  std::vector<double> lower(n_ * n_, 0.0);
  for (std::size_t i = 0; i < n_; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = matrix_[i * n_ + j] * scale[i] * scale[j];
      for (std::size_t k = 0; k < j; ++k) sum -= lower[i * n_ + k] * lower[j * n_ + k];
      if (i != j) {
        lower[i * n_ + j] = sum / lower[j * n_ + j];
      } else if (sum > kOpen) {
        lower[i * n_ + i] = std::sqrt(sum);
      } else {
        return failure({.code = ErrorCode::IncompleteData,
                        .tried = "fit a calibration job",
                        .seen = fmt::format("{} readings that leave parameter {} of {} open", rows_, i + 1, n_),
                        .limit = "readings that tell all of them apart"});
      }
    }
  }
  // The inverse of L, then covariance = L^-T L^-1.
  std::vector<double> inverse(n_ * n_, 0.0);
  for (std::size_t column = 0; column < n_; ++column) {
    for (std::size_t i = column; i < n_; ++i) {
      double sum = i == column ? 1.0 : 0.0;
      for (std::size_t k = column; k < i; ++k) sum -= lower[i * n_ + k] * inverse[k * n_ + column];
      inverse[i * n_ + column] = sum / lower[i * n_ + i];
    }
  }
  Step step{.change = std::vector<double>(n_, 0.0), .covariance = std::vector<double>(n_ * n_, 0.0)};
  for (std::size_t i = 0; i < n_; ++i) {
    for (std::size_t j = 0; j < n_; ++j) {
      double sum = 0.0;
      for (std::size_t k = std::max(i, j); k < n_; ++k) sum += inverse[k * n_ + i] * inverse[k * n_ + j];
      step.covariance[i * n_ + j] = sum * scale[i] * scale[j];
      step.change[i] += step.covariance[i * n_ + j] * right_[j];
    }
  }
  return step;
}

}  // namespace gonio::calibration
