#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "base/geometry.h"
#include "drivers/kinematics/turning_sample.h"

namespace gonio::drivers::test {

/// Forward geometry for the tests, on its own: 3 x 3 matrices of elementary turns, multiplied, in long double.
using Real = long double;
using Vector = std::array<Real, 3>;
using Matrix = std::array<Vector, 3>;  ///< rows

inline Vector operator*(const Matrix& m, const Vector& v) {
  Vector out{};
  for (std::size_t r = 0; r < 3; ++r) out[r] = m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2];
  return out;
}
inline Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix out{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) out[r][c] = a[r][0] * b[0][c] + a[r][1] * b[1][c] + a[r][2] * b[2][c];
  }
  return out;
}
inline Matrix transposed(const Matrix& m) {
  return {Vector{m[0][0], m[1][0], m[2][0]}, Vector{m[0][1], m[1][1], m[2][1]}, Vector{m[0][2], m[1][2], m[2][2]}};
}
inline Matrix turn_x(Angle by) {
  const Real c = std::cos(static_cast<Real>(by.si()));
  const Real s = std::sin(static_cast<Real>(by.si()));
  return {Vector{1, 0, 0}, Vector{0, c, -s}, Vector{0, s, c}};
}
inline Matrix turn_y(Angle by) {
  const Real c = std::cos(static_cast<Real>(by.si()));
  const Real s = std::sin(static_cast<Real>(by.si()));
  return {Vector{c, 0, s}, Vector{0, 1, 0}, Vector{-s, 0, c}};
}
inline Matrix turn_z(Angle by) {
  const Real c = std::cos(static_cast<Real>(by.si()));
  const Real s = std::sin(static_cast<Real>(by.si()));
  return {Vector{c, -s, 0}, Vector{s, c, 0}, Vector{0, 0, 1}};
}

/// On the sample: (along phi = 0, along phi = 90 deg, along the normal).
struct Directions {
  Vector source{};
  Vector detector{};
};

inline Vector direction(Angle theta, Angle phi) {
  const auto t = static_cast<Real>(theta.si());
  const auto p = static_cast<Real>(phi.si());
  return {std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
}
inline Directions directions_of_geometry(const Geometry& g) {
  return {direction(g.theta_i, g.phi_i), direction(g.theta_r, g.phi_r)};
}

/// As the convention of turning_sample.h has it: body X is the normal, Y is phi = 0, Z is phi = 90 deg.
inline Directions forward(const TurningSample& sample, const SampleTurns& turns) {
  const Matrix body_to_lab = turn_z(turns.yaw) * turn_y(turns.pitch) * turn_x(turns.roll);
  const Vector source_lab = turn_z(sample.source_azimuth) * (turn_y(-sample.source_elevation) * Vector{1, 0, 0});
  const Vector detector_lab = turn_x(sample.detector_plane_tilt) * (turn_z(turns.detector) * Vector{1, 0, 0});
  const auto on_sample = [&](const Vector& lab) {
    const Vector body = transposed(body_to_lab) * lab;
    return Vector{body[1], body[2], body[0]};
  };
  return {on_sample(source_lab), on_sample(detector_lab)};
}

/// The arc between two unit vectors: 2 asin(|a - b| / 2), exact for small arcs.
inline double arc(const Vector& a, const Vector& b) {
  const Real chord = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  return static_cast<double>(2.0L * std::asin(std::min<Real>(1.0L, 0.5L * chord)));
}

}  // namespace gonio::drivers::test
