#include "reflectance/convention/forward_angles.h"

#include <numbers>

#include "reflectance/convention/axis_angles.h"

namespace gonio::reflectance {

using namespace gonio::literals;

namespace {

constexpr Angle kHalfTurn = radians(std::numbers::pi);

}  // namespace

ForwardAngles to_forward(const Direction& i, const Direction& r) {
  return {.theta_i = i.theta(), .theta_r = r.theta(), .relative_azimuth = wrapped(relative_azimuth(i, r) - kHalfTurn)};
}

Result<DirectionPair> from_forward(const ForwardAngles& angles, Angle phi_i) {
  constexpr std::string_view kWhat = "angles with forward at azimuth 0";
  GONIO_TRY(check_angle(kWhat, "theta_i", angles.theta_i, 0.0_deg, 90.0_deg));
  GONIO_TRY(check_angle(kWhat, "theta_r", angles.theta_r, 0.0_deg, 90.0_deg));
  GONIO_TRY(check_azimuth(kWhat, "relative_azimuth", angles.relative_azimuth));
  GONIO_TRY(check_azimuth(kWhat, "phi_i", phi_i));
  const Angle phi_r = phi_i + (angles.relative_azimuth + kHalfTurn);
  return DirectionPair{.i = Direction::from_angles(angles.theta_i, phi_i),
                       .r = Direction::from_angles(angles.theta_r, phi_r)};
}

}  // namespace gonio::reflectance
