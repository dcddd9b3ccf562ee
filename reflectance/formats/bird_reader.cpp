#include <algorithm>
#include <cmath>
#include <compare>
#include <map>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "reflectance/formats/bird_file.h"
#include "reflectance/formats/bird_names.h"
#include "reflectance/formats/json_object.h"

namespace gonio::formats {
namespace {

using reflectance::TableSymmetry;

constexpr double kPercent = 0.01;

std::string known(std::string text) {
  return text == bird::kNotStated || text == bird::kNoEmail || text == bird::kNoTime ? std::string() : text;
}

std::optional<double> value_in(const JsonObject& object) {
  return object.number("value");
}

class BirdReader {
 public:
  BirdReader(const JsonObject& root, JsonSource& source) : root_(root), source_(source) {}

  Result<MeasuredBrdf> read() {
    root_.require("metadata");
    root_.require("data");
    read_metadata();
    read_data();
    if (source_.error) return failure(*source_.error);
    GONIO_TRY(check(brdf_, source_.file));
    return std::move(brdf_);
  }

 private:
  void read_metadata() {
    const JsonObject said = root_.object("metadata");
    said.require("sample");
    BrdfMetadata& m = brdf_.metadata;
    m.id = said.text("id");
    if (m.id.starts_with(bird::kUrn)) m.id.clear();
    m.description = known(said.text("description"));
    m.measured_at = known(said.text("timestamp"));
    m.method = static_cast<Method>(said.choice("method", {"measurement", "simulation"}));
    if (!said.is_text("software")) m.software = said.object("software").text("name");
    read_who(said.object("provenance"));
    read_sample(said.object("sample"));
    if (!said.is_text("environment")) {
      const JsonObject temperature = said.object("environment").object("temperature");
      constexpr double kKelvin = 273.15;
      m.temperature_c = value_in(temperature);
      if (m.temperature_c && temperature.text("unit") == "K") *m.temperature_c -= kKelvin;
    }
    read_instrument(said);
    read_adhoc_section(said.object("adhoc_section"));
  }

  void read_who(const JsonObject& who) {
    BrdfMetadata& m = brdf_.metadata;
    m.organisation = known(who.text("organization"));
    m.operator_name = known(who.text("contact_person"));
    m.email = known(who.text("email"));
    const JsonObject where = who.object("location");
    m.country = known(where.text("country"));
    m.city = known(where.text("city"));
    m.street = known(where.text("street"));
    m.building = known(where.text("building_nr"));
    m.postal_code = known(where.text("postal_code"));
  }

  void read_sample(const JsonObject& sample) {
    BrdfMetadata& m = brdf_.metadata;
    m.sample = known(sample.text("name"));
    m.sample_kind = known(sample.text("type"));
    m.zero_azimuth = known(sample.text("zero_azimuth_location"));
    const std::string symmetry = sample.text("properties_symmetry");
    if (symmetry == "isotropic") m.symmetry = TableSymmetry::Isotropic;
    if (symmetry.starts_with("isotropic,")) m.symmetry = TableSymmetry::Turn;
    if (symmetry == "anisotropic") m.symmetry = TableSymmetry::Anisotropic;
  }

  void read_instrument(const JsonObject& said) {
    if (said.is_text("instrumentation")) return;
    const JsonObject instrument = said.object("instrumentation");
    BrdfMetadata& m = brdf_.metadata;
    m.instrument = known(instrument.text("name"));
    m.detector_solid_angle_sr = value_in(instrument.object("detection_system").object("solid_angle"));
    const JsonObject area = instrument.object("illumination_system").object("beam").object("dimensions").object("area");
    if (area.text("unit") == "mm^2") m.beam_area_mm2 = value_in(area);
  }

  void read_adhoc_section(const JsonObject& said) {
    BrdfMetadata& m = brdf_.metadata;
    if (m.instrument.empty() && said.is_text("instrument")) m.instrument = said.text("instrument");
    if (const std::optional<double> area = said.number("beam_area_mm2")) m.beam_area_mm2 = area;
    if (const std::optional<double> angle = said.number("detector_solid_angle_sr")) m.detector_solid_angle_sr = angle;
    if (said.is_text("medium")) m.medium = said.text("medium");
    m.references = said.texts("references");
    brdf_.flag_names = said.texts("flag_names");
    channel_names_ = said.texts("channel_names");
    for (const JsonObject& remark : said.objects("remarks"))
      m.remarks.emplace_back(remark.text("key"), remark.text("text"));
  }

  // The values of data.KEY, as many as there are points; empty where an optional key is absent or after an error.
  std::vector<double> values(const JsonObject& data, std::string_view key) {
    const JsonObject said = data.object(key);
    if (!data.has(key)) return {};
    std::vector<double> found = said.numbers("values");
    if (!source_.error && found.size() != brdf_.points.size())
      said.fail("values", fmt::format("{} values", found.size()), fmt::format("{}, as theta_i", brdf_.points.size()));
    return source_.error ? std::vector<double>() : found;
  }

  void read_angle(const JsonObject& data, const char* key, double BrdfPoint::*field, double below_deg) {
    data.require(key);
    const std::vector<std::string_view> units{"deg", "rad", "°"};
    const bool is_radians = data.object(key).choice("unit", units) == 1;
    data.object(key).require("unit");
    const std::vector<double> found = values(data, key);
    for (std::size_t n = 0; n < found.size(); ++n) {
      const double angle = is_radians ? found[n] * (180.0 / std::numbers::pi) : found[n];
      if (!(angle >= 0.0 && angle < below_deg))
        data.fail(fmt::format("{}.values[{}]", key, n), fmt::format("{} deg", angle),
                  fmt::format("0 to below {} deg", below_deg));
      brdf_.points[n].*field = angle;
    }
  }

  void read_column(const JsonObject& data, std::string_view key, double BrdfPoint::*field) {
    const std::vector<double> found = values(data, key);
    for (std::size_t n = 0; n < found.size(); ++n) brdf_.points[n].*field = found[n];
  }

  void read_data() {
    const JsonObject data = root_.object("data");
    data.require("BRDF");
    if (source_.error) return;
    brdf_.points.resize(data.object("theta_i").numbers("values").size());
    read_angle(data, "theta_i", &BrdfPoint::theta_i_deg, 90.0);
    read_angle(data, "phi_i", &BrdfPoint::phi_i_deg, 360.0);
    read_angle(data, "theta_r", &BrdfPoint::theta_r_deg, 90.0);
    read_angle(data, "phi_r", &BrdfPoint::phi_r_deg, 360.0);
    const std::vector<std::string_view> units{"sr^-1", "1/sr", "%"};
    if (data.object("BRDF").choice("unit", units) == 2) data.object("BRDF").fail("unit", "'%'", "sr^-1");
    read_column(data, "BRDF", &BrdfPoint::f_per_sr);
    const bool is_relative = data.object("uBRDF").choice("unit", units) == 2;
    read_column(data, "uBRDF", &BrdfPoint::U_per_sr);
    if (is_relative)
      for (BrdfPoint& p : brdf_.points) p.U_per_sr *= kPercent * p.f_per_sr;
    read_adhoc_variables(data.object("adhoc_variables"));
    read_channels(data);
  }

  void read_adhoc_variables(const JsonObject& data) {
    read_column(data, bird::kSigned, &BrdfPoint::f_per_sr);
    read_column(data, bird::kCoverage, &BrdfPoint::k);
    read_column(data, bird::kShared, &BrdfPoint::u_shared_per_sr);
    if (brdf_.flag_names.empty()) return;
    const std::vector<double> flags = values(data, bird::kFlags);
    for (std::size_t n = 0; n < flags.size(); ++n) brdf_.points[n].flags = bits(data, bird::kFlags, flags[n]);
  }

  std::uint32_t bits(const JsonObject& data, std::string_view key, double value) {
    constexpr double kMostBits = 4294967295.0;
    if (value >= 0.0 && value <= kMostBits && value == std::floor(value)) return static_cast<std::uint32_t>(value);
    data.fail(key, fmt::format("{}", value), "a whole number of 32 bits");
    return 0;
  }

  // As the file writes them: "s", "p", "u" in quotes, or Stokes vectors.
  std::vector<std::string> polarisations(const JsonObject& data, std::string_view key) {
    if (!data.has(key)) return std::vector<std::string>(brdf_.points.size());
    const JsonObject said = data.object(key);
    std::vector<std::string> found = said.entries("values");
    if (found.size() != brdf_.points.size())
      said.fail("values", fmt::format("{} values", found.size()), fmt::format("{}, as theta_i", brdf_.points.size()));
    return found;
  }

  // A Stokes vector tells channels apart by their names: which sign of its second part is s, the schema does not say.
  static Polarisation polarisation(const std::string& said, std::string_view side, Channel& channel) {
    if (said == R"("s")") return Polarisation::S;
    if (said == R"("p")") return Polarisation::P;
    if (said == R"("u")") return Polarisation::Unpolarised;
    if (!said.empty()) channel.name += fmt::format(" {} {}", side, said);
    return Polarisation::Unknown;
  }

  struct Light {
    double wavelength_nm;
    std::string incident;
    std::string reflected;
    auto operator<=>(const Light&) const = default;
  };

  static Channel channel_of(const Light& light) {
    Channel channel = light.wavelength_nm > 0.0 ? channel_at(light.wavelength_nm) : Channel{};
    channel.incident = polarisation(light.incident, "incident", channel);
    channel.reflected = polarisation(light.reflected, "reflected", channel);
    return channel;
  }

  std::vector<Light> read_lights(const JsonObject& data) {
    constexpr double kMicrometre = 1000.0;
    std::vector<double> wavelengths = values(data, "wavelength_i");
    wavelengths.resize(brdf_.points.size());
    const bool is_micrometres = data.object("wavelength_i").text("unit") == "μm";
    const std::vector<std::string> incident = polarisations(data, "polarization_i");
    const std::vector<std::string> reflected = polarisations(data, "polarization_r");
    std::vector<Light> lights;
    for (std::size_t n = 0; n < brdf_.points.size() && !source_.error; ++n)
      lights.push_back({is_micrometres ? kMicrometre * wavelengths[n] : wavelengths[n], incident[n], reflected[n]});
    return lights;
  }

  // A channel for each kind of light; our own files say which of their channels a point had.
  void read_channels(const JsonObject& data) {
    const std::vector<Light> lights = read_lights(data);
    if (!channel_names_.empty()) return read_own_channels(data.object("adhoc_variables"), lights);
    std::map<Light, std::uint32_t> by_light;
    for (std::size_t n = 0; n < lights.size(); ++n) {
      const auto [at, is_new] = by_light.emplace(lights[n], static_cast<std::uint32_t>(brdf_.channels.size()));
      if (is_new) brdf_.channels.push_back(channel_of(lights[n]));
      brdf_.points[n].channel = at->second;
    }
  }

  void read_own_channels(const JsonObject& adhoc, const std::vector<Light>& lights) {
    adhoc.require(bird::kChannel);
    const std::vector<double> own = values(adhoc, bird::kChannel);
    brdf_.channels.resize(channel_names_.size());
    for (std::size_t n = 0; n < own.size(); ++n) {
      const std::uint32_t index = bits(adhoc, bird::kChannel, own[n]);
      brdf_.points[n].channel = index;
      if (index >= channel_names_.size()) continue;  // `check` refuses it
      brdf_.channels[index] = channel_of(lights[n]);
      brdf_.channels[index].name = channel_names_[index];
    }
  }

  const JsonObject& root_;
  JsonSource& source_;
  std::vector<std::string> channel_names_;
  MeasuredBrdf brdf_;
};

}  // namespace

Result<MeasuredBrdf> read_bird(std::string_view text, const std::string& file) {
  JsonSource source{.format = "BiRD JSON", .file = file};
  const Result<nlohmann::json> parsed = parse_json(text, source);
  if (!parsed) return failure(parsed.error());
  const JsonObject root(&*parsed, "", source);
  return BirdReader(root, source).read();
}

}  // namespace gonio::formats
