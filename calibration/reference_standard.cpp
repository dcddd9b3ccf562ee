#include "calibration/reference_standard.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace gonio::calibration {
namespace {

// An encoder's last digits must not refuse a point planned exactly at the table's edge.
constexpr Angle kEdge = degrees(0.1);
// Below the resolution of any filter or grating of these instruments: the same wavelength, written twice.
constexpr Wavelength kSameWavelength = nanometres(0.01);

Error out_of_reach(const ReferenceDefinition& d, std::string seen, std::string limit, const InputLocation& where) {
  return {.code = ErrorCode::ReferenceOutOfReach,
          .device = {},
          .tried = "use the reference standard " + d.serial,
          .seen = std::move(seen),
          .limit = std::move(limit),
          .where = where};
}

}  // namespace

ReferenceStandard::ReferenceStandard(ReferenceDefinition definition) : definition_(std::move(definition)) {
  const Certificate& c = definition_.certificate;
  const auto mean = [&](const std::function<double(const Geometry&)>& s) {
    return certificate_mean(s, definition_.shape, c.geometry, c.specular_port);
  };
  const double norm = mean([&](const Geometry& g) { return definition_.shape.value(g); });
  scale_ = 1.0 / norm;
  for (const ShapeMode& mode : definition_.modes) {
    mode_means_.push_back(mean([&](const Geometry& g) { return definition_.shape.value(g) * mode.value(g); }) / norm);
  }
}

Result<ReferenceStandard> ReferenceStandard::parse(std::string_view toml, const std::string& file) {
  return parse_reference(toml, file).map([](ReferenceDefinition d) { return ReferenceStandard(std::move(d)); });
}

Result<void> ReferenceStandard::check_date(UtcTime at) const {
  // Dates in ISO 8601 compare as texts.
  const std::string today = iso8601(at).substr(0, 10);
  const Certificate& c = definition_.certificate;
  if (c.date <= today && today <= c.expires) return {};
  return failure({.code = ErrorCode::ReferenceExpired,
                  .device = {},
                  .tried = "use the reference standard " + serial(),
                  .seen = fmt::format("the date {}", today),
                  .limit = fmt::format("its certificate holds from {} to {}", c.date, c.expires),
                  .where = definition_.expires_at});
}

Result<void> ReferenceStandard::check_reach(Wavelength wavelength, const Geometry& g) const {
  GONIO_TRY(reflectance(wavelength));
  const auto beyond = [&](Angle theta, const std::vector<Angle>& grid, std::string_view name) {
    return out_of_reach(definition_, fmt::format("{} = {:.3f} deg", name, in_degrees(theta)),
                        fmt::format("the shape table ends at {:.3f} deg", in_degrees(grid.back())),
                        definition_.shape_at);
  };
  const ShapeTable& table = definition_.shape;
  if (g.theta_i > table.theta_i().back() + kEdge) return failure(beyond(g.theta_i, table.theta_i(), "theta_i"));
  if (g.theta_r > table.theta_r().back() + kEdge) return failure(beyond(g.theta_r, table.theta_r(), "theta_r"));
  return {};
}

Result<Measured<double>> ReferenceStandard::reflectance(Wavelength wavelength) const {
  const Certificate& c = definition_.certificate;
  const auto above = std::ranges::find_if(
      c.entries, [&](const CertificateEntry& e) { return e.wavelength >= wavelength - kSameWavelength; });
  if (above != c.entries.end() && above->wavelength <= wavelength + kSameWavelength) {
    return Measured<double>{.value = above->reflectance, .u = above->u};
  }
  const std::string seen = fmt::format("wavelength {:.3f} nm", in_nanometres(wavelength));
  if (above == c.entries.begin() || above == c.entries.end()) {
    return failure(out_of_reach(
        definition_, seen,
        fmt::format("the certificate covers {:.3f} to {:.3f} nm", in_nanometres(c.entries.front().wavelength),
                    in_nanometres(c.entries.back().wavelength)),
        definition_.entries_at));
  }
  const CertificateEntry& below = *(above - 1);
  const Wavelength gap = above->wavelength - below.wavelength;
  if (gap > c.longest_gap) {
    return failure(out_of_reach(
        definition_, seen,
        fmt::format("between {:.3f} and {:.3f} nm the certificate has a gap longer than {:.3f} nm",
                    in_nanometres(below.wavelength), in_nanometres(above->wavelength), in_nanometres(c.longest_gap)),
        definition_.entries_at));
  }
  const double fraction = (wavelength - below.wavelength) / gap;
  return Measured<double>{.value = below.reflectance + fraction * (above->reflectance - below.reflectance),
                          .u = below.u + fraction * (above->u - below.u)};
}

}  // namespace gonio::calibration
