#include "reflectance/convention/specular_centred_angles.h"

#include <cmath>
#include <string_view>

#include "reflectance/convention/axis_angles.h"

namespace gonio::reflectance {

using namespace gonio::literals;

// With d half of the difference of azimuths, about the mirror direction m of i: r has the component
// sin(theta_i - theta_r) + 2 mu_i sin(theta_r) cos^2 d towards the normal and -2 sin(theta_r) sin d cos d aside;
// sin^2 and cos^2 of half the arc follow from those of i and r by exchanging sin d and cos d.
SpecularCentredAngles to_specular_centred(const Direction& i, const Direction& r) {
  const HalfAzimuth half = half_azimuth(i, r);
  const double facing2 = half.cosine * half.cosine;
  const double sines = i.sin_theta() * r.sin_theta();
  const double sin2_half = separation_terms(i, r).tilt2 + sines * facing2;
  const double cos2_half = sum_terms(i, r).rise2 + sines * (half.sine * half.sine);
  const double inward = std::sin(2.0 * half_theta_difference(i, r)) + 2.0 * i.mu() * r.sin_theta() * facing2;
  const double aside = -2.0 * r.sin_theta() * half.sine * half.cosine;
  const Angle azimuth = sin2_half == 0.0 ? Angle{} : wrapped(radians(std::atan2(aside, inward)));
  return {.theta_i = i.theta(),
          .phi_i = i.phi(),
          .radial = radians(2.0 * std::atan2(std::sqrt(sin2_half), std::sqrt(cos2_half))),
          .azimuth = azimuth};
}

Result<DirectionPair> from_specular_centred(const SpecularCentredAngles& angles) {
  constexpr std::string_view kWhat = "specular-centred angles";
  GONIO_TRY(check_angle(kWhat, "radial", angles.radial, 0.0_deg, 180.0_deg));
  GONIO_TRY(check_azimuth(kWhat, "azimuth", angles.azimuth));
  const Result<Direction> i = Direction::make(angles.theta_i, angles.phi_i);
  if (!i) return failure(i.error());
  // Light along the normal has its mirror direction there too, and azimuths from phi = 0.
  const AxisTurn turn = AxisTurn::of(angles.azimuth);
  const bool is_upright = i->sin_theta() == 0.0;
  const Result<Direction> r = direction_about(mirrored(*i), angles.radial.si(), is_upright ? turn.opposite() : turn,
                                              "r about the mirror direction");
  if (!r) return failure(r.error());
  return DirectionPair{.i = *i, .r = *r};
}

}  // namespace gonio::reflectance
