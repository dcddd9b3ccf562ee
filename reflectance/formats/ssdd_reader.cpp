#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>

#include <fmt/format.h>

#include "reflectance/convention/nbs160_angles.h"
#include "reflectance/convention/rusinkiewicz_angles.h"
#include "reflectance/convention/specular_centred_angles.h"
#include "reflectance/formats/byte_io.h"
#include "reflectance/formats/ssdd_file.h"
#include "reflectance/formats/text_lines.h"

namespace gonio::formats {
namespace {

using reflectance::DirectionPair;

constexpr std::size_t kParams = 4;
using Params = std::array<double, kParams>;  // degrees

Result<DirectionPair> spherical_pair(const Params& p) {
  return reflectance::from_nbs160(
      {.theta_i = degrees(p[0]), .phi_i = degrees(p[1]), .theta_r = degrees(p[2]), .phi_r = degrees(p[3])});
}
Result<DirectionPair> specular_pair(const Params& p) {
  return reflectance::from_specular_centred(
      {.theta_i = degrees(p[0]), .phi_i = degrees(p[1]), .radial = degrees(p[2]), .azimuth = degrees(p[3])});
}
Result<DirectionPair> half_difference_pair(const Params& p) {
  return reflectance::from_rusinkiewicz(
      {.theta_h = degrees(p[0]), .phi_h = degrees(p[1]), .theta_d = degrees(p[2]), .phi_d = degrees(p[3])});
}

struct Parameterisation {
  std::string_view name;
  Result<DirectionPair> (*pair)(const Params&);
  double most_of_2;  // of PARAM2_LIST, degrees
};
constexpr std::array kParameterisations{
    Parameterisation{"spherical_coordinate_system", spherical_pair, 90.0},
    Parameterisation{"specular_coordinate_system", specular_pair, 180.0},
    Parameterisation{"half_difference_coordinate_system", half_difference_pair, 90.0}};

class SsddReader {
 public:
  SsddReader(std::string_view bytes, const std::string& file) : lines_(bytes, "SSDD", file) {}

  Result<MeasuredBrdf> read() {
    GONIO_TRY(read_header());
    GONIO_TRY(take_header());
    const bool is_binary = entries_.at("DATA") == "binary";
    GONIO_TRY(is_binary ? read_binary() : read_text());
    if (!is_binary) GONIO_TRY(lines_.check_end());
    const std::optional<std::string_view> next = is_binary ? std::nullopt : lines_.next_filled();
    if (next) GONIO_TRY(check_is_no_value(*next));
    const bool has_more = next || (is_binary && !trimmed(lines_.rest().substr(binary_bytes())).empty());
    if (has_more) brdf_.metadata.remarks.emplace_back("left out", "what follows the BRDF: other blocks are not read");
    GONIO_TRY(check(brdf_, lines_.file()));
    return std::move(brdf_);
  }

 private:
  // KEY value, until DATA.
  Result<void> read_header() {
    while (const std::optional<std::string_view> line = lines_.next_filled()) {
      const auto [key, rest] = key_and_rest(*line);
      if (entries_.empty() && key != "VERSION")
        return failure(lines_.error("VERSION", fmt::format("'{}'", one_line(key.substr(0, 40))), "VERSION first"));
      entries_.emplace(key, rest);
      if (key == "DATA") return {};
    }
    return failure(lines_.error("DATA", "the file ends within its header"));
  }

  std::string_view entry(const std::string& key) const {
    const auto at = entries_.find(key);
    return at == entries_.end() ? std::string_view() : at->second;
  }

  Result<void> take_header() {
    if (entry("DATA_TYPE") != "brdf")
      return failure(lines_.error("DATA_TYPE", fmt::format("'{}'", entry("DATA_TYPE").substr(0, 40)), "brdf"));
    if (entry("DATA") != "ascii" && entry("DATA") != "binary")
      return failure(lines_.error("DATA", fmt::format("'{}'", entry("DATA").substr(0, 40)), "ascii or binary"));
    const auto found = std::ranges::find(kParameterisations, entry("PARAM_TYPE"), &Parameterisation::name);
    if (found == kParameterisations.end())
      return failure(lines_.error("PARAM_TYPE", fmt::format("'{}'", entry("PARAM_TYPE").substr(0, 40)),
                                  "spherical, specular or half_difference_coordinate_system"));
    parameterisation_ = &*found;
    GONIO_TRY(take_channels());
    GONIO_TRY(take_list("PARAM0_LIST", 90.0, true, axes_[0]));
    GONIO_TRY(take_list("PARAM1_LIST", 360.0, false, axes_[1]));
    GONIO_TRY(take_list("PARAM2_LIST", found->most_of_2, true, axes_[2]));
    GONIO_TRY(take_list("PARAM3_LIST", 360.0, true, axes_[3]));
    const bool is_mirrored = entry("REDUCTION_TYPE").find("bilateral") != std::string_view::npos;
    if (axes_[1].size() == 1)
      brdf_.metadata.symmetry = is_mirrored ? reflectance::TableSymmetry::Isotropic : reflectance::TableSymmetry::Turn;
    brdf_.metadata.sample = entry("NAME");
    brdf_.metadata.instrument = entry("DEVICE");
    brdf_.metadata.measured_at = entry("MEASUREMENT_DATE");
    if (entry("SOURCE_TYPE") == "generated") brdf_.metadata.method = Method::Simulation;
    return check_size();
  }

  Result<void> take_channels() {
    const std::string_view model = entry("COLOR_MODEL");
    if (model == "monochrome") brdf_.channels = {Channel{}};
    if (model == "rgb") brdf_.channels = {{.name = "R"}, {.name = "G"}, {.name = "B"}};
    if (model == "xyz") brdf_.channels = {{.name = "X"}, {.name = "Y"}, {.name = "Z"}};
    if (model != "spectrum") {
      if (!brdf_.channels.empty()) return {};
      return failure(
          lines_.error("COLOR_MODEL", fmt::format("'{}'", model.substr(0, 40)), "monochrome, rgb, xyz or spectrum"));
    }
    constexpr double kMostWavelength = 1e9;
    std::vector<double> wavelengths;
    GONIO_TRY(take_list("WAVELENGTH_LIST", kMostWavelength, true, wavelengths));
    for (const double wavelength : wavelengths) brdf_.channels.push_back(channel_at(wavelength));
    return {};
  }

  Result<void> take_list(const std::string& key, double most, bool is_needed, std::vector<double>& values) {
    const std::string_view text = entry(key);
    if (text.empty() && !is_needed) {
      values = {0.0};
      return {};
    }
    Result<std::vector<double>> numbers = lines_.numbers(text, key, words(text).size());
    if (!numbers) return failure(numbers.error());
    values = *std::move(numbers);
    const bool rises = std::ranges::adjacent_find(values, std::greater_equal<double>()) == values.end();
    if (rises && !values.empty() && values.front() >= 0.0 && values.back() <= most) return {};
    return failure(lines_.error(key, values.empty() ? "no numbers" : "numbers that do not rise, or out of range",
                                fmt::format("rising, 0 to {}", most)));
  }

  // Each value takes two bytes of text ("0\n") or four of binary: a list that claims more is not believed.
  Result<void> check_size() {
    const std::size_t least_bytes = entry("DATA") == "binary" ? sizeof(float) : 2;
    const std::size_t most = std::min(kMostPoints, lines_.bytes_left() / least_bytes + 1);
    std::size_t count = brdf_.channels.size();
    for (const std::vector<double>& axis : axes_) {
      count *= axis.size();
      if (count > most)
        return failure(lines_.error("PARAM0_LIST to PARAM3_LIST", fmt::format("{} values or more", count),
                                    fmt::format("{} fit in the file", most)));
    }
    return {};
  }

  // Another block begins with a word. A number says that a list is short of an angle, so that values stand elsewhere.
  Result<void> check_is_no_value(std::string_view line) const {
    if (!lines_.number(key_and_rest(line).key, "DATA")) return {};
    return failure(lines_.error("DATA", "more values than PARAM0_LIST to PARAM3_LIST have directions", "one for each"));
  }

  template <class Take>
  Result<void> for_each_direction(Take take) {
    for (const double p3 : axes_[3])
      for (const double p2 : axes_[2])
        for (const double p1 : axes_[1])
          for (const double p0 : axes_[0]) GONIO_TRY(take(Params{p0, p1, p2, p3}));
    return {};
  }

  Result<void> read_text() {
    return for_each_direction([this](const Params& params) -> Result<void> {
      const std::optional<std::string_view> line = lines_.next_filled();
      if (!line) return failure(lines_.error("DATA", "the file ends within its values"));
      const Result<std::vector<double>> values = lines_.numbers(*line, "DATA", brdf_.channels.size());
      if (!values) return failure(values.error());
      add_points(params, *values);
      return {};
    });
  }

  std::size_t binary_bytes() const {
    std::size_t count = brdf_.channels.size() * sizeof(float);
    for (const std::vector<double>& axis : axes_) count *= axis.size();
    return count;
  }

  Result<void> read_binary() {
    ByteReader bytes(lines_.rest(), "SSDD", lines_.file());
    return for_each_direction([&](const Params& params) -> Result<void> {
      std::vector<double> values;
      for (std::size_t n = 0; n < brdf_.channels.size(); ++n) {
        const Result<float> value = bytes.number<float>("DATA");
        if (!value) return failure(value.error());
        values.push_back(*value);
      }
      add_points(params, values);
      return {};
    });
  }

  void add_points(const Params& params, const std::vector<double>& values) {
    const Result<DirectionPair> d = parameterisation_->pair(params);
    if (!d) return;
    BrdfPoint point{.theta_i_deg = params[0], .phi_i_deg = params[1], .theta_r_deg = params[2], .phi_r_deg = params[3]};
    if (parameterisation_ != kParameterisations.data()) {
      point = {.theta_i_deg = in_degrees(d->i.theta()),
               .phi_i_deg = plain_azimuth_deg(in_degrees(d->i.phi())),
               .theta_r_deg = in_degrees(d->r.theta()),
               .phi_r_deg = plain_azimuth_deg(in_degrees(d->r.phi()))};
    }
    for (std::size_t n = 0; n < values.size(); ++n) {
      point.channel = static_cast<std::uint32_t>(n);
      point.f_per_sr = values[n];
      brdf_.points.push_back(point);
    }
  }

  TextLines lines_;
  std::map<std::string, std::string_view> entries_;
  const Parameterisation* parameterisation_ = nullptr;
  std::array<std::vector<double>, kParams> axes_;
  MeasuredBrdf brdf_;
};

}  // namespace

Result<MeasuredBrdf> read_ssdd(std::string_view bytes, const std::string& file) {
  return SsddReader(bytes, file).read();
}

}  // namespace gonio::formats
