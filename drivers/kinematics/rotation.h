#pragma once

#include <array>
#include <cmath>

#include "base/units.h"

namespace gonio::drivers {

/// Three components; plain data for the few products that kinematics needs.
struct Vector3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};

[[nodiscard]] constexpr double dot(const Vector3& a, const Vector3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[nodiscard]] constexpr Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// ca * a + cb * b.
[[nodiscard]] constexpr Vector3 combined(double ca, const Vector3& a, double cb, const Vector3& b) {
  return {ca * a.x + cb * b.x, ca * a.y + cb * b.y, ca * a.z + cb * b.z};
}

/// Right-handed turns of a vector about a fixed axis.
[[nodiscard]] inline Vector3 turned_about_x(const Vector3& v, Angle by) {
  const double c = std::cos(by.si());
  const double s = std::sin(by.si());
  return {v.x, c * v.y - s * v.z, s * v.y + c * v.z};
}
[[nodiscard]] inline Vector3 turned_about_y(const Vector3& v, Angle by) {
  const double c = std::cos(by.si());
  const double s = std::sin(by.si());
  return {c * v.x + s * v.z, v.y, c * v.z - s * v.x};
}
[[nodiscard]] inline Vector3 turned_about_z(const Vector3& v, Angle by) {
  const double c = std::cos(by.si());
  const double s = std::sin(by.si());
  return {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
}

/// A right-handed orthonormal frame; its vectors are the columns of a rotation.
using Triad = std::array<Vector3, 3>;

/// `frame` turned about its own first vector.
[[nodiscard]] inline Triad turned_about_first(const Triad& frame, Angle by) {
  const double c = std::cos(by.si());
  const double s = std::sin(by.si());
  return {frame[0], combined(c, frame[1], s, frame[2]), combined(c, frame[2], -s, frame[1])};
}

}  // namespace gonio::drivers
