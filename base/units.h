#pragma once

#include <cmath>
#include <compare>
#include <numbers>

namespace gonio {

/// A physical value in SI units (radian for angles), one double wide, so that a span of it is plain data.
/// Quantities of one kind add, subtract, compare and scale; different kinds do not mix. A product of two kinds exists
/// only where it is declared below. Made by a named function or a literal, read by `in_...`.
template <class Tag>
class Quantity {
 public:
  constexpr Quantity() = default;

  static constexpr Quantity from_si(double value) { return Quantity(value); }
  [[nodiscard]] constexpr double si() const { return value_; }

  constexpr Quantity operator-() const { return Quantity(-value_); }
  constexpr Quantity& operator+=(Quantity other) {
    value_ += other.value_;
    return *this;
  }
  constexpr Quantity& operator-=(Quantity other) {
    value_ -= other.value_;
    return *this;
  }

  friend constexpr Quantity operator+(Quantity a, Quantity b) { return Quantity(a.value_ + b.value_); }
  friend constexpr Quantity operator-(Quantity a, Quantity b) { return Quantity(a.value_ - b.value_); }
  friend constexpr Quantity operator*(Quantity a, double k) { return Quantity(a.value_ * k); }
  friend constexpr Quantity operator*(double k, Quantity a) { return Quantity(a.value_ * k); }
  friend constexpr Quantity operator/(Quantity a, double k) { return Quantity(a.value_ / k); }
  friend constexpr double operator/(Quantity a, Quantity b) { return a.value_ / b.value_; }
  friend constexpr auto operator<=>(Quantity, Quantity) = default;

 private:
  explicit constexpr Quantity(double value) : value_(value) {}
  double value_ = 0.0;
};

using Angle = Quantity<struct AngleTag>;              ///< rad
using SolidAngle = Quantity<struct SolidAngleTag>;    ///< sr
using Wavelength = Quantity<struct WavelengthTag>;    ///< m
using Length = Quantity<struct LengthTag>;            ///< m
using Temperature = Quantity<struct TemperatureTag>;  ///< K
using Brdf = Quantity<struct BrdfTag>;                ///< sr^-1

[[nodiscard]] constexpr Angle radians(double value) {
  return Angle::from_si(value);
}
[[nodiscard]] constexpr Angle degrees(double value) {
  return Angle::from_si(value * (std::numbers::pi / 180.0));
}
[[nodiscard]] constexpr double in_radians(Angle a) {
  return a.si();
}
[[nodiscard]] constexpr double in_degrees(Angle a) {
  return a.si() * (180.0 / std::numbers::pi);
}

[[nodiscard]] constexpr SolidAngle steradians(double value) {
  return SolidAngle::from_si(value);
}
[[nodiscard]] constexpr double in_steradians(SolidAngle a) {
  return a.si();
}

[[nodiscard]] constexpr Wavelength nanometres(double value) {
  return Wavelength::from_si(value * 1e-9);
}
[[nodiscard]] constexpr double in_nanometres(Wavelength l) {
  return l.si() * 1e9;
}

[[nodiscard]] constexpr Length millimetres(double value) {
  return Length::from_si(value * 1e-3);
}
[[nodiscard]] constexpr double in_millimetres(Length l) {
  return l.si() * 1e3;
}

[[nodiscard]] constexpr Temperature celsius(double value) {
  return Temperature::from_si(value + 273.15);
}
[[nodiscard]] constexpr double in_celsius(Temperature t) {
  return t.si() - 273.15;
}

[[nodiscard]] constexpr Brdf per_steradian(double value) {
  return Brdf::from_si(value);
}
[[nodiscard]] constexpr double in_per_steradian(Brdf f) {
  return f.si();
}

namespace literals {
constexpr Angle operator""_deg(long double v) {
  return degrees(static_cast<double>(v));
}
constexpr Angle operator""_deg(unsigned long long v) {
  return degrees(static_cast<double>(v));
}
constexpr Wavelength operator""_nm(long double v) {
  return nanometres(static_cast<double>(v));
}
constexpr Wavelength operator""_nm(unsigned long long v) {
  return nanometres(static_cast<double>(v));
}
constexpr Length operator""_mm(long double v) {
  return millimetres(static_cast<double>(v));
}
constexpr Length operator""_mm(unsigned long long v) {
  return millimetres(static_cast<double>(v));
}
}  // namespace literals

/// A value with its standard uncertainty (k = 1), both in the unit of T.
template <class T>
struct Measured {
  T value{};
  T u{};
};

}  // namespace gonio
