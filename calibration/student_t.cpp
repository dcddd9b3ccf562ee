#include "calibration/student_t.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace gonio::calibration {
namespace {

constexpr double kStudentLevel = 0.9545;
constexpr double kSeriesFrom = 200.0;  // degrees of freedom: there the series is good to 1e-11

// The regularised incomplete beta function I_x(a, b) by Lentz's continued fraction (NIST DLMF 8.17.22), which converges
// fast for x below (a + 1) / (a + b + 2).
double incomplete_beta(double x, double a, double b) {
  if (x <= 0.0) return 0.0;
  if (x > (a + 1.0) / (a + b + 2.0)) return 1.0 - incomplete_beta(1.0 - x, b, a);
  constexpr double kTiny = 1e-300;
  constexpr int kTermsAtMost = 500;
  double c = 1.0;
  double d = 1.0 / std::max(kTiny, 1.0 - (a + b) * x / (a + 1.0));
  double fraction = d;
  for (int m = 1; m <= kTermsAtMost; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1.0) * (a + 2 * m));
    d = 1.0 / (1.0 + even * d);
    c = 1.0 + even / c;
    fraction *= c * d;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1.0));
    d = 1.0 / (1.0 + odd * d);
    c = 1.0 + odd / c;
    fraction *= c * d;
    if (std::abs(c * d - 1.0) < 1e-15) break;
  }
  const double log_front = a * std::log(x) + b * std::log1p(-x) + std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b);
  return std::exp(log_front) * fraction / a;
}

// The share of Student's t with `nu` degrees of freedom within +-t: I_y(1/2, nu/2), y = t^2 / (nu + t^2).
double share_within(double t, double nu) {
  return incomplete_beta(t * t / (nu + t * t), 0.5, 0.5 * nu);
}

// Student's t at the level, as a series in x = 1 / nu about the normal z (Abramowitz and Stegun 1964, 26.7.5).
double series_of_t(double x) {
  constexpr double kNormal = 2.0000024438996;  // of 0.9545; the tables' 2.000
  const double z = kNormal;
  const double z2 = z * z;
  const double g1 = z * (z2 + 1.0) / 4.0;
  const double g2 = z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
  const double g3 = z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0;
  const double g4 = z * ((((79.0 * z2 + 776.0) * z2 + 1482.0) * z2 - 1920.0) * z2 - 945.0) / 92160.0;
  return z + (g1 + (g2 + (g3 + g4 * x) * x) * x) * x;
}

/// ln of the factor at even steps of x = 1 / degrees of freedom, where it is as smooth as a low polynomial.
class FactorTable {
 public:
  FactorTable() {
    for (std::size_t n = 0; n < log_factor_.size(); ++n) {
      const double x = static_cast<double>(n) / kStepsToOne;
      const bool is_in_series = x * kSeriesFrom < 1.0;
      log_factor_[n] = std::log(is_in_series ? series_of_t(x) : exact_student_factor(1.0 / x));
    }
  }

  // Between the six nodes about x (Lagrange; Abramowitz and Stegun 1964, 25.2.2).
  [[nodiscard]] double at(double x) const {
    const double place = x * kStepsToOne;
    const std::size_t first = static_cast<std::size_t>(std::max(place, kBefore)) - static_cast<std::size_t>(kBefore);
    const double p = place - static_cast<double>(first);
    constexpr std::array<double, kNodes> kFactorials{-120.0, 24.0, -12.0, 12.0, -24.0, 120.0};  // of k - m, m not k
    double sum = 0.0;
    for (std::size_t k = 0; k < kNodes; ++k) {
      double weight = 1.0 / kFactorials[k];
      for (std::size_t m = 0; m < kNodes; ++m) weight *= m == k ? 1.0 : p - static_cast<double>(m);
      sum += weight * log_factor_[first + k];
    }
    return std::exp(sum);
  }

 private:
  static constexpr double kStepsToOne = 512.0;
  static constexpr std::size_t kNodes = 6;
  static constexpr double kBefore = 2.0;  // nodes below the one that lies before x
  std::array<double, static_cast<std::size_t>(kStepsToOne) + 4> log_factor_{};
};

}  // namespace

double exact_student_factor(double degrees_of_freedom) {
  assert(degrees_of_freedom > 0.0);
  double low = 2.0;
  double high = 4.0;
  while (share_within(high, degrees_of_freedom) < kStudentLevel && high < 1e9) high *= 2.0;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (share_within(middle, degrees_of_freedom) < kStudentLevel ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double student_factor(double degrees_of_freedom) {
  assert(degrees_of_freedom > 0.0);
  if (degrees_of_freedom > kSeriesFrom) return series_of_t(1.0 / degrees_of_freedom);
  if (degrees_of_freedom < 1.0) return exact_student_factor(degrees_of_freedom);
  static const FactorTable table;
  return table.at(1.0 / degrees_of_freedom);
}

}  // namespace gonio::calibration
