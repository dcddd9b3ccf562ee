#include "reflectance/convention/nbs160_angles.h"

#include <numbers>

#include "reflectance/convention/axis_angles.h"

namespace gonio::reflectance {

using namespace gonio::literals;

namespace {

// Less than half an ulp of a turn below 0 it would round to a whole turn, which is 0.
Angle in_one_turn(Angle phi) {
  constexpr Angle kTurn = radians(2.0 * std::numbers::pi);
  if (phi >= 0.0_deg) return phi;
  const Angle turned = phi + kTurn;
  return turned < kTurn ? turned : Angle{};
}

}  // namespace

Nbs160Angles to_nbs160(const Direction& i, const Direction& r) {
  return {.theta_i = i.theta(), .phi_i = in_one_turn(i.phi()), .theta_r = r.theta(), .phi_r = in_one_turn(r.phi())};
}

Result<DirectionPair> from_nbs160(const Nbs160Angles& angles) {
  constexpr std::string_view kWhat = "the angles of NBS 160";
  GONIO_TRY(check_angle(kWhat, "theta_i", angles.theta_i, 0.0_deg, 90.0_deg));
  GONIO_TRY(check_azimuth(kWhat, "phi_i", angles.phi_i));
  GONIO_TRY(check_angle(kWhat, "theta_r", angles.theta_r, 0.0_deg, 90.0_deg));
  GONIO_TRY(check_azimuth(kWhat, "phi_r", angles.phi_r));
  return DirectionPair{.i = Direction::from_angles(angles.theta_i, angles.phi_i),
                       .r = Direction::from_angles(angles.theta_r, angles.phi_r)};
}

}  // namespace gonio::reflectance
