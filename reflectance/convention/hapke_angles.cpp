#include "reflectance/convention/hapke_angles.h"

#include <algorithm>

#include <fmt/format.h>

#include "reflectance/convention/axis_angles.h"

namespace gonio::reflectance {

using namespace gonio::literals;

namespace {

constexpr std::string_view kWhat = "Hapke's angles";

Result<void> check_ranges(const HapkeAngles& angles) {
  GONIO_TRY(check_angle(kWhat, "i", angles.i, 0.0_deg, 90.0_deg));
  GONIO_TRY(check_angle(kWhat, "e", angles.e, 0.0_deg, 90.0_deg));
  GONIO_TRY(check_azimuth(kWhat, "psi", angles.psi));
  return check_angle(kWhat, "g", angles.g, 0.0_deg, 180.0_deg);
}

Error no_such_phase(Angle g, Angle least, Angle most) {
  return {.code = ErrorCode::InvalidInput,
          .tried = fmt::format("read {}", kWhat),
          .seen = fmt::format("g {} deg", in_degrees(g)),
          .limit = fmt::format("{} to {} deg for this i and e", in_degrees(least), in_degrees(most))};
}

double half_sine(Angle a) {
  return std::max(0.0, std::sin(0.5 * a.si()));
}

}  // namespace

HapkeAngles to_hapke(const Direction& i, const Direction& r) {
  return {.i = i.theta(), .e = r.theta(), .psi = relative_azimuth(i, r), .g = phase_angle(i, r)};
}

Result<DirectionPair> from_hapke(const HapkeAngles& angles, Angle phi_i, Angle tolerance) {
  GONIO_TRY(check_ranges(angles));
  GONIO_TRY(check_azimuth(kWhat, "phi_i", phi_i));
  GONIO_TRY(check_angle(kWhat, "tolerance", tolerance, 0.0_deg, 180.0_deg));
  const DirectionPair pair{.i = Direction::from_angles(angles.i, phi_i),
                           .r = Direction::from_angles(angles.e, phi_i + angles.psi)};
  // Seen from i at its pole the azimuth is lost, and with it nothing of g.
  const Angle g = phase_angle(pair.i, pair.r);
  if (std::abs((g - angles.g).si()) <= tolerance.si()) return pair;
  return failure(
      {.code = ErrorCode::InvalidInput,
       .tried = fmt::format("read {}", kWhat),
       .seen = fmt::format("g {:.9g} deg where i, e and psi make {:.9g} deg", in_degrees(angles.g), in_degrees(g)),
       .limit = fmt::format("a difference of {} deg", in_degrees(tolerance))});
}

Result<HapkeAngles> hapke_from_phase(Angle i, Angle e, Angle g) {
  constexpr Angle kRounding = radians(1e-15);
  GONIO_TRY(check_ranges({.i = i, .e = e, .psi = {}, .g = g}));
  const Angle least = i < e ? e - i : i - e;
  const Angle most = i + e;
  if (g < least - kRounding || g > most + kRounding) return failure(no_such_phase(g, least, most));
  HapkeAngles angles{.i = i, .e = e, .psi = {}, .g = g};
  if (i == 0.0_deg || e == 0.0_deg) return angles;
  const double s2 = half_sine(g + (i - e)) * half_sine(g - (i - e));
  const double c2 = half_sine(most + g) * half_sine(most - g);
  angles.psi = radians(2.0 * std::atan2(std::sqrt(s2), std::sqrt(c2)));
  return angles;
}

}  // namespace gonio::reflectance
