#include "calibration/coverage_interval.h"

#include <cmath>
#include <numbers>

namespace gonio::calibration {
namespace {

constexpr double kHeldLevel = 0.9545;

double normal_integral(double z) {
  const double cumulative = 0.5 * std::erfc(-z / std::numbers::sqrt2);
  return z * cumulative + std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
}

}  // namespace

double coverage_factor_with_rectangle(double ratio) {
  constexpr double kAsGoodAsNone = 1e-2;
  constexpr double kAsGoodAsAlone = 1e3;
  if (ratio < kAsGoodAsNone) return 2.0;
  if (ratio > kAsGoodAsAlone) return kHeldLevel * std::numbers::sqrt3;
  const double a = std::numbers::sqrt3 * ratio;  // s = 1
  const auto held = [&](double x) { return (normal_integral(x + a) - normal_integral(x - a)) / a - 1.0; };
  const double u = std::hypot(1.0, ratio);
  double low = 1.6 * u;
  double high = 2.1 * u;
  for (int step = 0; step < 50; ++step) {
    const double middle = 0.5 * (low + high);
    (held(middle) < kHeldLevel ? low : high) = middle;
  }
  return 0.5 * (low + high) / u;
}

}  // namespace gonio::calibration
