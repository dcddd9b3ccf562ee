#include "reflectance/direction/direction.h"

#include <cassert>

#include <fmt/format.h>

namespace gonio::reflectance {
namespace {

constexpr double kHalfPi = 0.5 * std::numbers::pi;
// What is left of 90 deg beyond the nearest double: without it the elevation of an angle just below is off by 6e-17.
constexpr double kHalfPiRest = 6.123233995736766e-17;

double complement(double angle) {
  return (kHalfPi - angle) + kHalfPiRest;
}

struct Tilt {
  double theta;
  double elevation;
};

// The smaller of the two from the arc tangent, the other as its complement: both to full relative precision.
Tilt tilt_of(double up, double across) {
  if (across <= up) {
    const double theta = std::atan2(across, up);
    return {.theta = theta, .elevation = complement(theta)};
  }
  const double elevation = std::atan2(up, across);
  return {.theta = complement(elevation), .elevation = elevation};
}

Angle phi_of(double sin_theta, Angle phi) {
  if (sin_theta == 0.0) return {};  // the pole has no azimuth
  const bool is_wrapped = phi.si() > -std::numbers::pi && phi.si() <= std::numbers::pi;
  return is_wrapped ? phi : wrapped(phi);
}

bool is_quarter_turn(Angle a) {
  return a.si() >= 0.0 && a.si() <= kHalfPi;
}  // false for NaN

Direction direction_of_arm(Angle theta, Angle phi) {
  if (theta.si() >= 0.0) return Direction::from_angles(theta, phi);
  return Direction::from_angles(-theta, phi + radians(std::numbers::pi));
}

Error bad_angle(std::string_view name, Angle a, std::string_view limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = "make a direction",
          .seen = fmt::format("{} {} deg", name, in_degrees(a)),
          .limit = std::string(limit)};
}

}  // namespace

Direction::Direction(double mu, double sin_theta, double theta, double elevation, Angle phi)
    : mu_(mu),
      sin_theta_(sin_theta),
      theta_(radians(theta)),
      elevation_(radians(elevation)),
      phi_(phi_of(sin_theta, phi)) {}

Direction Direction::from_angles(Angle theta, Angle phi) {
  assert(is_quarter_turn(theta) && std::isfinite(phi.si()));
  return {std::cos(theta.si()), std::sin(theta.si()), theta.si(), complement(theta.si()), phi};
}

Direction Direction::from_elevation(Angle elevation, Angle phi) {
  assert(is_quarter_turn(elevation) && std::isfinite(phi.si()));
  // 90 deg as the nearest double is the pole to whoever asks for it.
  const bool is_pole = elevation.si() == kHalfPi;
  const double sin_theta = is_pole ? 0.0 : std::cos(elevation.si());
  const double theta = is_pole ? 0.0 : complement(elevation.si());
  return {std::sin(elevation.si()), sin_theta, theta, elevation.si(), phi};
}

Direction Direction::from_vector(const Vector& v) {
  const double length = std::hypot(v.x, v.y, v.z);
  assert(std::isfinite(length) && length > 0.0 && v.z >= 0.0);
  const double across = std::hypot(v.x, v.y);  // never sqrt(1 - mu^2): that has no digits near the pole
  const Angle phi = across > 0.0 ? radians(std::atan2(v.y, v.x)) : Angle{};
  const Tilt tilt = tilt_of(v.z, across);
  return {v.z / length, across / length, tilt.theta, tilt.elevation, phi};
}

Direction Direction::from_cosine(double mu, double sin_theta, Angle phi) {
  assert(mu >= 0.0 && sin_theta >= 0.0 && std::abs(std::hypot(mu, sin_theta) - 1.0) < 1e-12 && std::isfinite(phi.si()));
  const Tilt tilt = tilt_of(mu, sin_theta);
  return {mu, sin_theta, tilt.theta, tilt.elevation, phi};
}

Result<Direction> Direction::make(Angle theta, Angle phi) {
  if (!is_quarter_turn(theta)) return failure(bad_angle("theta", theta, "0 to 90 deg"));
  if (!std::isfinite(phi.si())) return failure(bad_angle("phi", phi, "a finite angle"));
  return from_angles(theta, phi);
}

Result<Direction> Direction::make_from_elevation(Angle elevation, Angle phi) {
  if (!is_quarter_turn(elevation)) return failure(bad_angle("elevation", elevation, "0 to 90 deg"));
  if (!std::isfinite(phi.si())) return failure(bad_angle("phi", phi, "a finite angle"));
  return from_elevation(elevation, phi);
}

Result<Direction> Direction::make_from_vector(const Vector& v) {
  const double length = std::hypot(v.x, v.y, v.z);
  if (std::isfinite(length) && length > 0.0 && v.z >= 0.0) return from_vector(v);
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = "make a direction",
                  .seen = fmt::format("vector ({}, {}, {})", v.x, v.y, v.z),
                  .limit = "finite, not zero, z at least 0"});
}

Vector Direction::vector() const {
  return {.x = sin_theta_ * std::cos(phi_.si()), .y = sin_theta_ * std::sin(phi_.si()), .z = mu_};
}

Direction incident_direction(const Geometry& g) {
  return direction_of_arm(g.theta_i, g.phi_i);
}

Direction reflected_direction(const Geometry& g) {
  return direction_of_arm(g.theta_r, g.phi_r);
}

Geometry geometry_of(const Direction& i, const Direction& r) {
  return {.theta_i = i.theta(), .phi_i = i.phi(), .theta_r = r.theta(), .phi_r = r.phi()};
}

Direction mirrored(const Direction& i) {
  Direction turned = i;
  turned.phi_ = phi_of(i.sin_theta(), i.phi() + radians(std::numbers::pi));
  return turned;
}

Angle azimuth_difference(const Direction& i, const Direction& r) {
  return wrapped(r.phi() - i.phi());
}

Angle phase_angle(const Direction& i, const Direction& r) {
  return radians(2.0 * std::atan2(std::sqrt(sin2_half_phase(i, r)), std::sqrt(cos2_half_phase(i, r))));
}

double cos_phase(const Direction& i, const Direction& r) {
  const double s2 = sin2_half_phase(i, r);
  // Each form where it does not cancel: 1 - 2 s2 towards retro, 2 c2 - 1 towards the opposite.
  return s2 < 0.5 ? 1.0 - 2.0 * s2 : 2.0 * cos2_half_phase(i, r) - 1.0;
}

double retro_distance(const Direction& i, const Direction& r) {
  return retro_distance(separation_terms(i, r), i.mu() * r.mu());
}

}  // namespace gonio::reflectance
