#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace gonio::fit {

/// A number and its slopes along three parameters, carried through a formula: forward differentiation (Wengert 1964),
/// exact to rounding. Where a formula is not differentiable (the root of 0), slopes are not finite.
struct Dual {
  static constexpr std::size_t kSlopes = 3;
  double v = 0.0;
  std::array<double, kSlopes> d{};

  constexpr Dual() = default;
  constexpr Dual(double value) : v(value) {}  // NOLINT: a number is a number without slopes
  /// The parameter `k` itself.
  static constexpr Dual parameter(double value, std::size_t k) {
    Dual x(value);
    x.d[k] = 1.0;
    return x;
  }
};

/// A function of value `v` and slope `slope` at x.v.
[[nodiscard]] constexpr Dual chained(const Dual& x, double v, double slope) {
  Dual y(v);
  for (std::size_t k = 0; k < Dual::kSlopes; ++k) y.d[k] = slope * x.d[k];
  return y;
}

[[nodiscard]] constexpr Dual operator-(const Dual& x) {
  return chained(x, -x.v, -1.0);
}
[[nodiscard]] constexpr Dual operator+(const Dual& a, const Dual& b) {
  Dual y(a.v + b.v);
  for (std::size_t k = 0; k < Dual::kSlopes; ++k) y.d[k] = a.d[k] + b.d[k];
  return y;
}
[[nodiscard]] constexpr Dual operator-(const Dual& a, const Dual& b) {
  Dual y(a.v - b.v);
  for (std::size_t k = 0; k < Dual::kSlopes; ++k) y.d[k] = a.d[k] - b.d[k];
  return y;
}
[[nodiscard]] constexpr Dual operator*(const Dual& a, const Dual& b) {
  Dual y(a.v * b.v);
  for (std::size_t k = 0; k < Dual::kSlopes; ++k) y.d[k] = a.d[k] * b.v + a.v * b.d[k];
  return y;
}
[[nodiscard]] constexpr Dual operator/(const Dual& a, const Dual& b) {
  Dual y(a.v / b.v);
  for (std::size_t k = 0; k < Dual::kSlopes; ++k) y.d[k] = (a.d[k] - y.v * b.d[k]) / b.v;
  return y;
}

[[nodiscard]] inline Dual sqrt(const Dual& x) {
  const double root = std::sqrt(x.v);
  return chained(x, root, 0.5 / root);
}
[[nodiscard]] inline Dual exp(const Dual& x) {
  const double e = std::exp(x.v);
  return chained(x, e, e);
}
[[nodiscard]] inline Dual log(const Dual& x) {
  return chained(x, std::log(x.v), 1.0 / x.v);
}
/// `base` above 0, known exactly.
[[nodiscard]] inline Dual pow(double base, const Dual& x) {
  const double power = std::pow(base, x.v);
  return chained(x, power, power * std::log(base));
}
/// erfc, whose slope is -2/sqrt(pi) exp(-x^2).
[[nodiscard]] inline Dual erfc(const Dual& x) {
  return chained(x, std::erfc(x.v), -2.0 * std::numbers::inv_sqrtpi * std::exp(-x.v * x.v));
}

}  // namespace gonio::fit
