#include "reflectance/convention/rusinkiewicz_angles.h"

#include <cmath>
#include <string_view>

#include "reflectance/convention/axis_angles.h"

namespace gonio::reflectance {

using namespace gonio::literals;

// With d half of the difference of azimuths, t = tan((theta_i - theta_r)/2), s = sin(theta_i) + sin(theta_r) and
// m = mu_i + mu_r, in the frame turned to the mean azimuth,
//   i + r = (s cos d, m t sin d, m),   i - r = (m t cos d, s sin d, -s t),
// since sin(theta_i) - sin(theta_r) = m t and mu_i - mu_r = -s t. Turning both by the azimuth of i + r leaves
//   i - r = (s m t, 4 sin(theta_i) sin(theta_r) sin d cos d) / level across the plane of h: products only.
RusinkiewiczAngles to_rusinkiewicz(const Direction& i, const Direction& r) {
  const HalfAzimuth half = half_azimuth(i, r);
  const double t = std::tan(half_theta_difference(i, r));
  const double s = i.sin_theta() + r.sin_theta();
  const double m = i.mu() + r.mu();
  const double along = s * half.cosine;
  const double across = m * t * half.sine;
  const double level = std::hypot(along, across);
  RusinkiewiczAngles angles{
      .theta_h = radians(std::atan2(level, m)), .phi_h = {}, .theta_d = 0.5 * phase_angle(i, r), .phi_d = {}};
  const bool is_retro = t == 0.0 && (half.sine == 0.0 || s == 0.0);
  if (level == 0.0) {
    if (!is_retro) angles.phi_d = i.phi();
    return angles;
  }
  const Angle mean = i.phi() - radians(half.angle);
  angles.phi_h = wrapped(mean + radians(std::atan2(across, along)));
  const double aside = 4.0 * i.sin_theta() * r.sin_theta() * half.sine * half.cosine;
  const double outward = s * t * std::hypot(level, m);
  if (!is_retro) angles.phi_d = wrapped(radians(std::atan2(aside, outward)));
  return angles;
}

Result<DirectionPair> from_rusinkiewicz(const RusinkiewiczAngles& angles) {
  constexpr std::string_view kWhat = "half and difference angles";
  GONIO_TRY(check_angle(kWhat, "theta_h", angles.theta_h, 0.0_deg, 90.0_deg));
  GONIO_TRY(check_azimuth(kWhat, "phi_h", angles.phi_h));
  GONIO_TRY(check_angle(kWhat, "theta_d", angles.theta_d, 0.0_deg, 90.0_deg));
  GONIO_TRY(check_azimuth(kWhat, "phi_d", angles.phi_d));
  // At theta_h = 0 phi_h still turns the pair: the half vector has no azimuth to carry it.
  const bool is_upright = angles.theta_h == 0.0_deg;
  const Direction half = Direction::from_angles(angles.theta_h, angles.phi_h);
  const AxisTurn turn = AxisTurn::of(is_upright ? angles.phi_d + angles.phi_h : angles.phi_d);
  const Result<Direction> r = direction_about(half, angles.theta_d.si(), turn, "r of a half vector");
  if (!r) return failure(r.error());
  const Result<Direction> i = direction_about(half, angles.theta_d.si(), turn.opposite(), "i of a half vector");
  if (!i) return failure(i.error());
  return DirectionPair{.i = *i, .r = *r};
}

}  // namespace gonio::reflectance
