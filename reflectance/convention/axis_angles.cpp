#include "reflectance/convention/axis_angles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

namespace gonio::reflectance {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-15;

}  // namespace

HalfAzimuth half_azimuth(const Direction& i, const Direction& r) {
  constexpr double kTwoUlpOfPi = 4.0 * std::numeric_limits<double>::epsilon();
  const double half = 0.5 * wrapped(i.phi() - r.phi()).si();
  if (std::abs(half) >= 0.5 * (kPi - kTwoUlpOfPi)) {
    return {.angle = half, .sine = std::copysign(1.0, half), .cosine = 0.0};
  }
  return {.angle = half, .sine = std::sin(half), .cosine = std::cos(half)};
}

Angle relative_azimuth(const Direction& i, const Direction& r) {
  return r.sin_theta() == 0.0 ? Angle{} : azimuth_difference(i, r);
}

AxisTurn AxisTurn::of(Angle azimuth) {
  const double half = 0.5 * wrapped(azimuth).si();
  const double s = std::sin(half);
  const double c = std::cos(half);
  return {.cos2_half = c * c, .sin2_half = s * s, .sine = 2.0 * s * c};
}

Result<Direction> direction_about(const Direction& axis, double arc, const AxisTurn& turn, std::string_view what) {
  const double sin_arc = std::sin(arc);
  const double cos_arc = std::cos(arc);
  const double cosine = turn.cos2_half - turn.sin2_half;
  // The axis leans along x. x = sin(t) cos(arc) - cos(t) sin(arc) cos(azimuth), z = cos(t) cos(arc) + sin(t) sin(arc)
  // cos(azimuth), each as a sum of like signs: directly, or by way of the difference (x) and the sum (z) of the angles.
  const bool towards_normal = cosine > 0.0;
  const double x = towards_normal ? std::sin(axis.theta().si() - arc) + 2.0 * axis.mu() * sin_arc * turn.sin2_half
                                  : axis.sin_theta() * cos_arc - axis.mu() * sin_arc * cosine;
  const double z = towards_normal
                       ? axis.mu() * cos_arc + axis.sin_theta() * sin_arc * cosine
                       : std::sin(axis.elevation().si() - arc) + 2.0 * axis.sin_theta() * sin_arc * turn.cos2_half;
  const double y = -sin_arc * turn.sine;
  if (!(z >= -kRounding)) {
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = fmt::format("make {}", what),
                    .seen = fmt::format("elevation {:.6g} deg", in_degrees(radians(std::asin(std::max(z, -1.0))))),
                    .limit = "at least 0 deg"});
  }
  const Angle phi = axis.phi() + radians(std::atan2(y, x));
  return Direction::from_cosine(std::max(z, 0.0), std::hypot(x, y), phi);
}

Result<void> check_angle(std::string_view what, std::string_view name, Angle angle, Angle least, Angle most) {
  if (angle >= least && angle <= most) return {};  // false for NaN
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = fmt::format("read {}", what),
                  .seen = fmt::format("{} {} deg", name, in_degrees(angle)),
                  .limit = fmt::format("{} to {} deg", in_degrees(least), in_degrees(most))});
}

Result<void> check_azimuth(std::string_view what, std::string_view name, Angle angle) {
  if (std::isfinite(angle.si())) return {};
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = fmt::format("read {}", what),
                  .seen = fmt::format("{} {} deg", name, in_degrees(angle)),
                  .limit = "a finite angle"});
}

}  // namespace gonio::reflectance
