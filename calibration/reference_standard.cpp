#include "calibration/reference_standard.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

std::string certificate_error_name(const Certificate& certificate, const CertificateError& error) {
  if (!error.entry) return "certificate";
  return fmt::format("certificate at {:g} nm alone", in_nanometres(certificate.entries[*error.entry].wavelength));
}

ReferenceStandard::ReferenceStandard(ReferenceDefinition definition) : definition_(std::move(definition)) {
  const Certificate& c = definition_.certificate;
  for (const SpectralShape& shape : definition_.shapes) {
    const auto mean = [&](const std::function<double(const Geometry&)>& s) {
      return certificate_mean(s, shape.table, c.geometry, c.specular_port);
    };
    const double norm = mean([&](const Geometry& g) { return shape.table.value(g); });
    scales_.push_back(1.0 / norm);
    std::vector<double>& means = mode_means_.emplace_back();
    for (const ShapeMode& mode : definition_.modes) {
      means.push_back(mean([&](const Geometry& g) { return shape.table.value(g) * mode.value(g); }) / norm);
    }
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
  GONIO_TRY(check_shape_wavelength(wavelength));
  const ShapeTable& table = grid();
  if (g.theta_i > table.theta_i().back() + kEdge) return failure(beyond(g.theta_i, table.theta_i(), "theta_i"));
  if (g.theta_r > table.theta_r().back() + kEdge) return failure(beyond(g.theta_r, table.theta_r(), "theta_r"));
  return {};
}

bool ReferenceStandard::is_extrapolated(const Geometry& g) const {
  constexpr Angle kAtTheEdge = degrees(0.01);  // what encoders scatter about a planned angle
  return g.theta_i > last_theta_i() + kAtTheEdge || g.theta_r > last_theta_r() + kAtTheEdge;
}

Result<void> ReferenceStandard::check_shape_wavelength(Wavelength wavelength) const {
  const auto& shapes = definition_.shapes;
  const bool is_within = wavelength >= shapes.front().wavelength - kSameWavelength &&
                         wavelength <= shapes.back().wavelength + kSameWavelength;
  if (shapes.size() == 1 || is_within) return {};
  return failure(
      out_of_reach(definition_, fmt::format("wavelength {:.3f} nm", in_nanometres(wavelength)),
                   fmt::format("the shape tables cover {:.3f} to {:.3f} nm", in_nanometres(shapes.front().wavelength),
                               in_nanometres(shapes.back().wavelength)),
                   definition_.shape_wavelengths_at));
}

ShapeRises ReferenceStandard::shape_rises(const Geometry& g, Wavelength wavelength, const ShapeSteps& steps) const {
  const auto add = [&](std::size_t n, double weight, ShapeRises& sum) {
    const ShapeRises rises = definition_.shapes[n].table.rises(g, steps);
    for (std::size_t axis = 0; axis < sum.size(); ++axis) sum[axis] += weight * scales_[n] * rises[axis];
  };
  const Place place = definition_.shapes.size() == 1 ? Place{} : place_of(wavelength);
  ShapeRises sum{};
  add(place.below, 1.0 - place.fraction, sum);
  if (place.fraction > 0.0) add(place.below + 1, place.fraction, sum);
  return sum;
}

ReferenceStandard::Place ReferenceStandard::place_of(Wavelength wavelength) const {
  const auto& shapes = definition_.shapes;
  const auto above =
      std::ranges::find_if(shapes, [&](const SpectralShape& shape) { return shape.wavelength > wavelength; });
  if (above == shapes.begin()) return {};
  const auto below = static_cast<std::size_t>(above - shapes.begin()) - 1;
  if (above == shapes.end()) return {below, 0.0};
  const Wavelength from = shapes[below].wavelength;
  return {below, (wavelength - from) / (above->wavelength - from)};
}

Result<ReferenceStandard::Place> ReferenceStandard::entry_place(Wavelength wavelength) const {
  const Certificate& c = definition_.certificate;
  const auto above = std::ranges::find_if(
      c.entries, [&](const CertificateEntry& e) { return e.wavelength >= wavelength - kSameWavelength; });
  const auto index = static_cast<std::size_t>(above - c.entries.begin());
  if (above != c.entries.end() && above->wavelength <= wavelength + kSameWavelength) return Place{index, 0.0};
  const auto seen = [&] { return fmt::format("wavelength {:.3f} nm", in_nanometres(wavelength)); };
  if (above == c.entries.begin() || above == c.entries.end()) {
    return failure(out_of_reach(
        definition_, seen(),
        fmt::format("the certificate covers {:.3f} to {:.3f} nm", in_nanometres(c.entries.front().wavelength),
                    in_nanometres(c.entries.back().wavelength)),
        definition_.entries_at));
  }
  const CertificateEntry& below = *(above - 1);
  const Wavelength gap = above->wavelength - below.wavelength;
  if (gap > c.longest_gap) {
    return failure(out_of_reach(
        definition_, seen(),
        fmt::format("between {:.3f} and {:.3f} nm the certificate has a gap longer than {:.3f} nm",
                    in_nanometres(below.wavelength), in_nanometres(above->wavelength), in_nanometres(c.longest_gap)),
        definition_.entries_at));
  }
  return Place{index - 1, (wavelength - below.wavelength) / gap};
}

Result<Measured<double>> ReferenceStandard::reflectance(Wavelength wavelength) const {
  const Result<Place> place = entry_place(wavelength);
  if (!place) return failure(place.error());
  const auto& entries = definition_.certificate.entries;
  const CertificateEntry& below = entries[place->below];
  if (place->fraction == 0.0) return Measured<double>{.value = below.reflectance, .u = below.u};
  const CertificateEntry& above = entries[place->below + 1];
  const double r = definition_.certificate.correlation;
  const double u_below = (1.0 - place->fraction) * below.u;
  const double u_above = place->fraction * above.u;
  // (a + b)^2 less what is not common; for r = 1 the sum to its last bit.
  const double u =
      r == 1.0 ? u_below + u_above : std::sqrt(u_below * u_below + u_above * u_above + 2.0 * r * u_below * u_above);
  return Measured<double>{.value = below.reflectance + place->fraction * (above.reflectance - below.reflectance),
                          .u = u};
}

Result<std::vector<CertificateError>> ReferenceStandard::certificate_errors(Wavelength wavelength) const {
  const Result<Place> place = entry_place(wavelength);
  if (!place) return failure(place.error());
  const Certificate& c = definition_.certificate;
  const double rho = reflectance(wavelength)->value;
  const double u_below = (1.0 - place->fraction) * c.entries[place->below].u / rho;
  const double u_above = place->fraction > 0.0 ? place->fraction * c.entries[place->below + 1].u / rho : 0.0;
  std::vector<CertificateError> errors;
  const auto add = [&](std::optional<std::size_t> entry, double u) {
    if (u > 0.0) errors.push_back({entry, u});
  };
  add(std::nullopt, std::sqrt(c.correlation) * (u_below + u_above));
  add(place->below, std::sqrt(1.0 - c.correlation) * u_below);
  add(place->below + 1, std::sqrt(1.0 - c.correlation) * u_above);
  return errors;
}

}  // namespace gonio::calibration
