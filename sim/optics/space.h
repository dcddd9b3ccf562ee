#pragma once

#include <cmath>

#include "base/units.h"
#include "reflectance/direction/direction.h"

namespace gonio::sim {

using reflectance::Vector;

// Vectors of the simulator's geometry: the lab's frame and the surface's are both as in reflectance/direction.
[[nodiscard]] constexpr Vector operator+(const Vector& a, const Vector& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
[[nodiscard]] constexpr Vector operator-(const Vector& a, const Vector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
[[nodiscard]] constexpr Vector operator*(double k, const Vector& v) {
  return {k * v.x, k * v.y, k * v.z};
}
[[nodiscard]] constexpr double dot(const Vector& a, const Vector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[nodiscard]] constexpr Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[nodiscard]] inline double length(const Vector& v) {
  return std::sqrt(dot(v, v));
}
/// `v` not zero.
[[nodiscard]] inline Vector normalised(const Vector& v) {
  return (1.0 / length(v)) * v;
}
[[nodiscard]] inline Vector unit_vector(Angle theta, Angle phi) {
  const double s = std::sin(theta.si());
  return {s * std::cos(phi.si()), s * std::sin(phi.si()), std::cos(theta.si())};
}
/// Of a direction with azimuth phi, across the plane of the normal: towards growing phi.
[[nodiscard]] inline Vector horizontal(Angle phi) {
  return {-std::sin(phi.si()), std::cos(phi.si()), 0.0};
}
/// In [0, 180 deg].
[[nodiscard]] inline Angle polar_angle(const Vector& v) {
  return radians(std::atan2(std::hypot(v.x, v.y), v.z));
}
/// 0 at the pole.
[[nodiscard]] inline Angle azimuth(const Vector& v) {
  return v.x == 0.0 && v.y == 0.0 ? Angle{} : radians(std::atan2(v.y, v.x));
}

}  // namespace gonio::sim
