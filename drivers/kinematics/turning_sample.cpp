#include "drivers/kinematics/turning_sample.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/kinematics/rotation.h"

namespace gonio::drivers {
namespace {

constexpr Angle kHalfTurn = radians(std::numbers::pi);
// So near to each other or opposite, source and detector do not say how the sample is turned about them; and whatever
// is chosen is wrong by no more than this.
constexpr double kFree_rad = 1e-13;

// Frames whose first vector is a direction and whose others are the tangents along growing theta and phi.
Triad body_frame(Angle theta, Angle phi) {
  const double st = std::sin(theta.si());
  const double ct = std::cos(theta.si());
  const double sp = std::sin(phi.si());
  const double cp = std::cos(phi.si());
  return {Vector3{ct, st * cp, st * sp}, Vector3{-st, ct * cp, ct * sp}, Vector3{0.0, -sp, cp}};
}

Triad source_frame(const TurningSample& sample) {
  const double ca = std::cos(sample.source_azimuth.si());
  const double sa = std::sin(sample.source_azimuth.si());
  const double ce = std::cos(sample.source_elevation.si());
  const double se = std::sin(sample.source_elevation.si());
  return {Vector3{ce * ca, ce * sa, se}, Vector3{-sa, ca, 0.0}, Vector3{-se * ca, -se * sa, ce}};
}

Vector3 detector_direction(const TurningSample& sample, Angle arm) {
  return turned_about_x({std::cos(arm.si()), std::sin(arm.si()), 0.0}, sample.detector_plane_tilt);
}

// Where a direction lies about the first vector of a frame, from the second towards the third.
Angle bearing(const Triad& frame, const Vector3& v) {
  return radians(std::atan2(dot(v, frame[2]), dot(v, frame[1])));
}

// The same for the detector in the frame of the source on the sample, without forming small differences of products:
// along theta  cos ti sin tr cos dphi - sin ti cos tr = sin(tr - ti) - 2 cos ti sin tr sin^2(dphi/2).
Angle bearing_on_sample(const Geometry& g) {
  const double dphi = (g.phi_r - g.phi_i).si();
  const double sin_tr = std::sin(g.theta_r.si());
  const double half = std::sin(0.5 * dphi);
  return radians(std::atan2(sin_tr * std::sin(dphi), std::sin((g.theta_r - g.theta_i).si()) -
                                                         2.0 * std::cos(g.theta_i.si()) * sin_tr * half * half));
}

Vector3 to_lab(const SampleTurns& turns, const Vector3& body) {
  return turned_about_z(turned_about_y(turned_about_x(body, turns.roll), turns.pitch), turns.yaw);
}

Vector3 to_body(const SampleTurns& turns, const Vector3& lab) {
  return turned_about_x(turned_about_y(turned_about_z(lab, -turns.yaw), -turns.pitch), -turns.roll);
}

// The rotation that carries one frame into another, as the images of the body's X, Y and Z.
Triad carrying(const Triad& body, const Triad& lab) {
  const auto image = [&](double a, double b, double c) {
    return combined(1.0, combined(a, lab[0], b, lab[1]), c, lab[2]);
  };
  return {image(body[0].x, body[1].x, body[2].x), image(body[0].y, body[1].y, body[2].y),
          image(body[0].z, body[1].z, body[2].z)};
}

// How far `lab` must be turned about its first vector for the rotation from `body` to be nearest to how the sample
// stands: the trace of the product with the standing rotation is largest there.
Angle nearest_turn(const Triad& body, const Triad& lab, const SampleTurns& standing) {
  const Vector3 second = to_lab(standing, body[1]);
  const Vector3 third = to_lab(standing, body[2]);
  return radians(std::atan2(dot(second, lab[2]) - dot(third, lab[1]), dot(second, lab[1]) + dot(third, lab[2])));
}

// Pitch and roll for a given yaw: R' = Rz(-yaw) R = Ry(pitch) Rx(roll), read where its entries are largest. Holds all
// digits also with the normal along the yaw axis, where any yaw will do.
SampleTurns taken_apart(const Triad& rotation, Angle yaw, Angle detector) {
  const Vector3 normal = turned_about_z(rotation[0], -yaw);
  const Vector3 y = turned_about_z(rotation[1], -yaw);
  const Vector3 z = turned_about_z(rotation[2], -yaw);
  return {.yaw = yaw,
          .pitch = radians(std::atan2(-normal.z, normal.x)),
          .roll = radians(std::atan2(-z.y, y.y)),
          .detector = detector};
}

// The source's elevation above the plane of the detector's arm, and its azimuth in it, from x.
struct SourceInPlane {
  Angle elevation;
  Angle azimuth;
};
SourceInPlane in_plane(const TurningSample& sample) {
  const Vector3 s = turned_about_x(source_frame(sample)[0], -sample.detector_plane_tilt);
  return {radians(std::atan2(s.z, std::hypot(s.x, s.y))), radians(std::atan2(s.y, s.x))};
}

// The arm's angle from below the source, d: cos xi = cos e cos d, as half angles so that nothing cancels:
// sin^2(d/2) = sin((xi+e)/2) sin((xi-e)/2) / cos e, cos^2(d/2) = cos((xi+e)/2) cos((xi-e)/2) / cos e.
Result<Angle> arm_from_source(Angle xi, Angle elevation) {
  const double e = std::abs(elevation.si());
  const double sines = std::sin(0.5 * (xi.si() + e)) * std::sin(0.5 * (xi.si() - e));
  const double cosines = std::cos(0.5 * (xi.si() + e)) * std::cos(0.5 * (xi.si() - e));
  if (xi.si() < e - kFree_rad || xi.si() > kHalfTurn.si() - e + kFree_rad) {
    return failure(
        {.code = ErrorCode::OutOfLimits,
         .device = "stage",
         .tried = fmt::format("bring the detector to a phase angle of {:.3f} deg", in_degrees(xi)),
         .seen = fmt::format("the source stands {:.3f} deg outside of the plane of the detector's arm",
                             in_degrees(radians(e))),
         .limit = fmt::format("{:.3f} to {:.3f} deg", in_degrees(radians(e)), in_degrees(kHalfTurn - radians(e)))});
  }
  return radians(2.0 * std::atan2(std::sqrt(std::max(0.0, sines)), std::sqrt(std::max(0.0, cosines))));
}

}  // namespace

Geometry directions_of(const TurningSample& sample, const SampleTurns& turns) {
  const auto theta = [](const Vector3& v) { return radians(std::atan2(std::hypot(v.y, v.z), v.x)); };
  const auto phi = [](const Vector3& v) { return radians(std::atan2(v.z, v.y)); };
  const Vector3 source = to_body(turns, source_frame(sample)[0]);
  const Vector3 detector = to_body(turns, detector_direction(sample, turns.detector));
  return {.theta_i = theta(source), .phi_i = phi(source), .theta_r = theta(detector), .phi_r = phi(detector)};
}

Angle separation_of(const TurningSample& sample, Angle detector) {
  const SourceInPlane source = in_plane(sample);
  return phase_angle({.theta_i = degrees(90.0) - source.elevation,
                      .phi_i = source.azimuth,
                      .theta_r = degrees(90.0),
                      .phi_r = detector});
}

Angle source_out_of_plane(const TurningSample& sample) {
  return in_plane(sample).elevation;
}

Result<std::vector<SampleTurns>> turns_for(const TurningSample& sample, const Geometry& g,
                                           const SampleTurns& standing) {
  const Angle xi = phase_angle(g);
  const SourceInPlane source = in_plane(sample);
  const Result<Angle> away = arm_from_source(xi, source.elevation);
  if (!away) return failure(away.error());
  const bool is_free = std::sin(xi.si()) < kFree_rad;
  const Triad on_sample = body_frame(g.theta_i, g.phi_i);
  const Triad in_lab = source_frame(sample);
  std::vector<SampleTurns> all;
  for (const double side : {1.0, -1.0}) {
    if (side < 0.0 && away->si() < kFree_rad) continue;  // both places of the arm are one
    const Angle arm = source.azimuth + side * *away;
    // Both frames are turned so that their second vectors point to the detector; then one is carried into the other.
    const Triad body = is_free ? on_sample : turned_about_first(on_sample, bearing_on_sample(g));
    const Triad lab = turned_about_first(
        in_lab, is_free ? nearest_turn(body, in_lab, standing) : bearing(in_lab, detector_direction(sample, arm)));
    const Triad rotation = carrying(body, lab);
    const bool along_yaw_axis = std::hypot(rotation[0].x, rotation[0].y) < kFree_rad;
    const Angle yaw = along_yaw_axis ? standing.yaw : radians(std::atan2(rotation[0].y, rotation[0].x));
    all.push_back(taken_apart(rotation, yaw, arm));
    all.push_back(taken_apart(rotation, yaw + kHalfTurn, arm));
  }
  return all;
}

}  // namespace gonio::drivers
