#include "sim/optics/turning_geometry.h"

#include <array>
#include <cmath>

namespace gonio::sim {
namespace {

struct Quaternion {
  double w = 1.0;
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};

Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

Quaternion conjugate(const Quaternion& q) {
  return {q.w, -q.x, -q.y, -q.z};
}

// A turn about one of the axes x, y, z.
Quaternion turn_about(std::size_t axis, Angle by) {
  std::array<double, 3> v{};
  v[axis] = std::sin(0.5 * by.si());
  return {std::cos(0.5 * by.si()), v[0], v[1], v[2]};
}

constexpr std::size_t kX = 0;
constexpr std::size_t kY = 1;
constexpr std::size_t kZ = 2;
constexpr Quaternion kAlongX{0.0, 1.0, 0.0, 0.0};

struct SampleDirection {
  Angle theta;
  Angle phi;
};

// Of a laboratory direction that comes from x by `from_x`, seen from a sample that is turned by `sample`.
SampleDirection seen_from(const Quaternion& sample, const Quaternion& from_x) {
  const Quaternion turn = conjugate(sample) * from_x;
  const Quaternion v = turn * kAlongX * conjugate(turn);
  return {radians(std::atan2(std::sqrt(v.y * v.y + v.z * v.z), v.x)), radians(std::atan2(v.z, v.y))};
}

}  // namespace

Geometry directions_on(const TurningSampleSpec& sample, const SampleTurn& turn) {
  const Quaternion stands = turn_about(kZ, turn.yaw) * turn_about(kY, turn.pitch) * turn_about(kX, turn.roll);
  const SampleDirection source =
      seen_from(stands, turn_about(kZ, sample.source_azimuth) * turn_about(kY, -sample.source_elevation));
  const SampleDirection detector =
      seen_from(stands, turn_about(kX, sample.detector_plane_tilt) * turn_about(kZ, turn.detector_arm));
  return {.theta_i = source.theta, .phi_i = source.phi, .theta_r = detector.theta, .phi_r = detector.phi};
}

}  // namespace gonio::sim
