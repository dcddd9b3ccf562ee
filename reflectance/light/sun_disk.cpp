#include "reflectance/light/sun_disk.h"

#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "reflectance/light/brightness.h"

namespace gonio::reflectance {
namespace {

constexpr Angle kMostRadius = degrees(45.0);
constexpr Angle kHorizon = radians(0.5 * std::numbers::pi);

Error bad_place(std::string_view field, Angle seen, std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = "make a sun disk",
          .seen = fmt::format("{} {} deg", field, in_degrees(seen)),
          .limit = std::move(limit),
          .where = InputLocation{.file = {}, .field = std::string(field)}};
}

Result<void> check_place(const SunPlace& p) {
  if (!(p.radius > Angle{} && p.radius <= kMostRadius)) {
    return failure(bad_place("radius", p.radius, "above 0 deg (a beam has none), at most 45 deg"));
  }
  if (!(p.theta >= Angle{} && p.theta < kHorizon + p.radius)) {
    return failure(bad_place("theta", p.theta,
                             fmt::format("0 to {} deg, where the disk has set", in_degrees(kHorizon + p.radius))));
  }
  if (!std::isfinite(p.phi.si())) return failure(bad_place("phi", p.phi, "a finite angle"));
  return {};
}

}  // namespace

Result<SunDisk> SunDisk::make(const SunPlace& place, double radiance) {
  GONIO_TRY(check_place(place));
  GONIO_TRY(check_brightness("sun disk", "radiance", radiance));
  return SunDisk(place, radiance);
}

Result<SunDisk> SunDisk::make_from_normal_irradiance(const SunPlace& place, double normal_irradiance) {
  GONIO_TRY(check_place(place));
  GONIO_TRY(check_brightness("sun disk", "normal_irradiance", normal_irradiance));
  const double s = std::sin(place.radius.si());
  return SunDisk(place, normal_irradiance / (std::numbers::pi * s * s));
}

bool SunDisk::covers(const Direction& i) const {
  const double tilt = std::sin(0.5 * (i.theta() - place_.theta).si());
  const double turn = std::sin(0.5 * (i.phi() - place_.phi).si());
  const double edge = std::sin(0.5 * place_.radius.si());
  return tilt * tilt + i.sin_theta() * std::sin(place_.theta.si()) * turn * turn <= edge * edge;
}

bool SunDisk::is_cut() const {
  return place_.theta + place_.radius > kHorizon;
}

}  // namespace gonio::reflectance
