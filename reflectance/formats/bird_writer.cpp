#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "reflectance/formats/bird_file.h"
#include "reflectance/formats/bird_names.h"

namespace gonio::formats {
namespace {

using nlohmann::ordered_json;
using reflectance::TableSymmetry;

std::string stated(const std::string& text) {
  return text.empty() ? std::string(bird::kNotStated) : text;
}

// A URI of letters that need no escape.
std::string uri_of(const BrdfMetadata& metadata) {
  if (!metadata.id.empty()) return metadata.id;
  std::string name = metadata.sample.empty() ? "brdf" : metadata.sample;
  std::ranges::replace_if(
      name,
      [](unsigned char c) { return !((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')); },
      '-');
  return std::string(bird::kUrn) + name;
}

ordered_json provenance(const BrdfMetadata& m) {
  return {{"organization", stated(m.organisation)},
          {"location",
           {{"country", stated(m.country)},
            {"city", stated(m.city)},
            {"street", stated(m.street)},
            {"building_nr", stated(m.building)},
            {"postal_code", stated(m.postal_code)}}},
          {"email", m.email.empty() ? std::string(bird::kNoEmail) : m.email},
          {"contact_person", stated(m.operator_name)}};
}

// What the schema has no key for. It has one for the instrument, but no half-known one: whoever gives it must give the
// lamp's power and the sensor's range, too.
ordered_json adhoc_section(const MeasuredBrdf& brdf) {
  const BrdfMetadata& m = brdf.metadata;
  ordered_json said = ordered_json::object();
  if (!m.instrument.empty()) said["instrument"] = m.instrument;
  if (m.beam_area_mm2) said["beam_area_mm2"] = *m.beam_area_mm2;
  if (m.detector_solid_angle_sr) said["detector_solid_angle_sr"] = *m.detector_solid_angle_sr;
  if (!m.medium.empty()) said["medium"] = m.medium;
  if (!m.references.empty()) said["references"] = m.references;
  if (!brdf.flag_names.empty()) said["flag_names"] = brdf.flag_names;
  ordered_json names = ordered_json::array();
  for (const Channel& channel : brdf.channels) names.push_back(channel.name);
  said["channel_names"] = names;
  ordered_json remarks = ordered_json::array();
  for (const auto& [key, text] : m.remarks) remarks.push_back({{"key", key}, {"text", text}});
  if (!remarks.empty()) said["remarks"] = remarks;
  return said;
}

ordered_json sample(const BrdfMetadata& m) {
  ordered_json said{{"name", stated(m.sample)},
                    {"type", stated(m.sample_kind)},
                    {"dimensions", ordered_json::object()},
                    {"shape", bird::kNotStated},
                    {"zero_azimuth_location", stated(m.zero_azimuth)}};
  constexpr std::array<std::string_view, 3> kWords{"isotropic", "isotropic, not mirror-symmetric", "anisotropic"};
  if (m.symmetry) said["properties_symmetry"] = kWords.at(static_cast<std::size_t>(*m.symmetry));
  return said;
}

ordered_json metadata(const MeasuredBrdf& brdf) {
  const BrdfMetadata& m = brdf.metadata;
  ordered_json said{{"schema", bird::kSchema},
                    {"id", uri_of(m)},
                    {"type", "BRDF"},
                    {"timestamp", m.measured_at.empty() ? std::string(bird::kNoTime) : m.measured_at},
                    {"provenance", provenance(m)},
                    {"description", stated(m.description)},
                    {"method", m.method == Method::Simulation ? "simulation" : "measurement"},
                    {"instrumentation", bird::kNotApplicable}};
  said["software"] = m.software.empty() ? ordered_json(bird::kNotApplicable) : ordered_json{{"name", m.software}};
  said["sample"] = sample(m);
  said["environment"] = bird::kNotApplicable;
  if (m.temperature_c) said["environment"] = {{"temperature", {{"value", *m.temperature_c}, {"unit", "°C"}}}};
  said["adhoc_section"] = adhoc_section(brdf);
  return said;
}

using Points = std::vector<BrdfPoint>;

template <class Value>
ordered_json column(const Points& points, Value value) {
  ordered_json values = ordered_json::array();
  for (const BrdfPoint& point : points) values.push_back(std::invoke(value, point));
  return values;
}

ordered_json adhoc(const ordered_json& values, std::string_view description, std::string_view unit,
                   std::string_view type = "number") {
  return {{"description", description}, {"unit", unit}, {"type", type}, {"values", values}};
}

std::string_view letter(Polarisation p) {
  return p == Polarisation::S ? "s" : p == Polarisation::P ? "p" : "u";
}

void put_polarisation(ordered_json& data, const MeasuredBrdf& brdf, const Points& points, const char* key,
                      Polarisation Channel::*side) {
  const bool is_told =
      std::ranges::all_of(brdf.channels, [side](const Channel& c) { return c.*side != Polarisation::Unknown; });
  if (!is_told) return;
  data[key] = {{"notation", "sp"},
               {"values", column(points, [&](const BrdfPoint& p) { return letter(brdf.channels[p.channel].*side); })}};
}

ordered_json adhoc_variables(const MeasuredBrdf& brdf, const Points& points) {
  ordered_json said = ordered_json::object();
  said[bird::kSigned] = adhoc(column(points, &BrdfPoint::f_per_sr),
                              "BRDF with its sign: BRDF itself shows negative net values as 0", "sr^-1");
  said[bird::kCoverage] =
      adhoc(column(points, &BrdfPoint::k), "coverage factor of uBRDF, which is expanded; 0: not stated", "1");
  said[bird::kShared] = adhoc(column(points, &BrdfPoint::u_shared_per_sr),
                              "part of the standard uncertainty that all points share", "sr^-1");
  said[bird::kChannel] =
      adhoc(column(points, &BrdfPoint::channel), "index into channel_names of the metadata", "1", "integer");
  if (!brdf.flag_names.empty())
    said[bird::kFlags] =
        adhoc(column(points, &BrdfPoint::flags), "bit n stands for flag_names[n] of the metadata", "1", "integer");
  return said;
}

ordered_json data(const MeasuredBrdf& brdf, const Points& points) {
  ordered_json said = ordered_json::object();
  const auto angle = [&](const char* key, double BrdfPoint::*field) {
    said[key] = {{"unit", "deg"}, {"values", column(points, field)}};
  };
  angle("theta_i", &BrdfPoint::theta_i_deg);
  angle("phi_i", &BrdfPoint::phi_i_deg);
  angle("theta_r", &BrdfPoint::theta_r_deg);
  angle("phi_r", &BrdfPoint::phi_r_deg);
  said["BRDF"] = {{"unit", "sr^-1"},
                  {"values", column(points, [](const BrdfPoint& p) { return std::max(p.f_per_sr, 0.0); })}};
  said["uBRDF"] = {{"unit", "sr^-1"}, {"values", column(points, &BrdfPoint::U_per_sr)}};
  if (std::ranges::all_of(brdf.channels, [](const Channel& c) { return c.wavelength_nm > 0.0; })) {
    said["wavelength_i"] = {
        {"unit", "nm"},
        {"values", column(points, [&](const BrdfPoint& p) { return brdf.channels[p.channel].wavelength_nm; })}};
  }
  put_polarisation(said, brdf, points, "polarization_i", &Channel::incident);
  put_polarisation(said, brdf, points, "polarization_r", &Channel::reflected);
  said["adhoc_variables"] = adhoc_variables(brdf, points);
  return said;
}

}  // namespace

Result<Export> write_bird(const MeasuredBrdf& brdf) {
  constexpr double kHorizon = 90.0;
  GONIO_TRY(check(brdf, "BiRD JSON"));
  Export written;
  Points points;
  for (const BrdfPoint& point : brdf.points) {
    const BrdfPoint plain = in_plain_ranges(point);
    if (plain.theta_i_deg < kHorizon && plain.theta_r_deg < kHorizon) points.push_back(plain);
  }
  add_loss(written.losses, LossKind::PointsDropped, brdf.points.size() - points.size(),
           "the schema has no direction at 90 deg");
  const auto negative = std::ranges::count_if(points, [](const BrdfPoint& p) { return p.f_per_sr < 0.0; });
  add_loss(written.losses, LossKind::Sign, static_cast<std::size_t>(negative),
           "the schema allows no negative BRDF: 0 stands there, the value in adhoc_variables.f_signed");
  if (points.empty())
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = "write BiRD JSON",
                    .seen = "all points lie at the horizon",
                    .limit = "theta below 90 deg"});
  const ordered_json whole{{"metadata", metadata(brdf)}, {"data", data(brdf, points)}};
  written.files.push_back(
      {.suffix = ".brdf", .bytes = whole.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n"});
  return written;
}

}  // namespace gonio::formats
