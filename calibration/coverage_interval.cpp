#include "calibration/coverage_interval.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace gonio::calibration {
namespace {

constexpr double kHeldLevel = 0.9545;

double normal_integral(double z) {
  const double cumulative = 0.5 * std::erfc(-z / std::numbers::sqrt2);
  return z * cumulative + std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
}

/// P(|X| <= x) of an X of standard deviation 1, as a series of sines.
class HeldSeries {
 public:
  HeldSeries(double u_normal, double u_rectangle, std::span<const double> u_arcsines) {
    constexpr double kVanished = 1e-10;
    for (; size_ < kTermsAtMost; ++size_) {
      const double n = static_cast<double>(size_ + 1);
      const double t = n * std::numbers::pi / kHalfPeriod;
      const double normal = std::exp(-0.5 * u_normal * u_normal * t * t);
      if (normal < kVanished) break;
      const double at = std::numbers::sqrt3 * u_rectangle * t;
      double all = at > 0.0 ? normal * std::sin(at) / at : normal;
      for (const double u : u_arcsines) all *= ::j0(std::numbers::sqrt2 * u * t);
      term_[size_] = 2.0 / (n * std::numbers::pi) * all;
    }
  }

  /// By Clenshaw's recurrence.
  [[nodiscard]] double held(double x) const {
    const double angle = std::numbers::pi * x / kHalfPeriod;
    const double twice_cosine = 2.0 * std::cos(angle);
    double next = 0.0;
    double after = 0.0;
    for (std::size_t n = size_; n > 0; --n) {
      const double here = term_[n - 1] + twice_cosine * next - after;
      after = next;
      next = here;
    }
    return x / kHalfPeriod + next * std::sin(angle);
  }

 private:
  static constexpr double kHalfPeriod = 5.0;  // beyond 10 - k of them nothing is left
  static constexpr std::size_t kTermsAtMost = 600;
  std::array<double, kTermsAtMost> term_{};
  std::size_t size_ = 0;
};

}  // namespace

double coverage_factor_with_bounds(double u_normal, double u_rectangle, std::span<const double> u_arcsines) {
  double arcsines2 = 0.0;
  for (const double u : u_arcsines) arcsines2 += u * u;
  if (arcsines2 == 0.0) {
    return coverage_factor_with_rectangle(u_normal > 0.0 ? u_rectangle / u_normal
                                                         : std::numeric_limits<double>::infinity());
  }
  constexpr double kLeastNormal = 0.02;
  constexpr std::size_t kArcsinesAtMost = 8;
  const double u = std::sqrt(u_normal * u_normal + u_rectangle * u_rectangle + arcsines2);
  std::array<double, kArcsinesAtMost> parts{};
  const std::size_t count = std::min(u_arcsines.size(), kArcsinesAtMost);
  for (std::size_t n = 0; n < count; ++n) parts[n] = u_arcsines[n] / u;
  const HeldSeries series(std::max(kLeastNormal, u_normal / u), u_rectangle / u, std::span(parts).first(count));
  double low = 1.4;  // of an arcsine alone 1.4106
  double high = 2.1;
  for (int step = 0; step < 40; ++step) {
    const double middle = 0.5 * (low + high);
    (series.held(middle) < kHeldLevel ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

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
