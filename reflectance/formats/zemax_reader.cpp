#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "reflectance/convention/specular_centred_angles.h"
#include "reflectance/formats/text_lines.h"
#include "reflectance/formats/zemax_file.h"

namespace gonio::formats {
namespace {

using reflectance::Direction;
using reflectance::DirectionPair;

// "# Sample: wheat" becomes the remark {"Sample", "wheat"}: laboratories write what the format has no key for there.
void keep_comment(std::string_view line, BrdfMetadata& metadata) {
  const std::string_view said = trimmed(line.substr(std::min(line.find_first_not_of('#'), line.size())));
  const std::size_t colon = said.find(": ");
  if (colon == std::string_view::npos) return;
  const std::string_view key = trimmed(said.substr(0, colon));
  const std::string_view text = trimmed(said.substr(colon + 1));
  if (text.empty()) return;
  if (key == "Sample") metadata.sample = text;
  if (key == "Instrument") metadata.instrument = text;
  if (key == "Measured") metadata.measured_at = text;
  if (key != "Sample" && key != "Instrument" && key != "Measured") metadata.remarks.emplace_back(key, text);
}

class ZemaxReader {
 public:
  ZemaxReader(std::string_view text, const std::string& file) : lines_(text, "Zemax text", file) {}

  Result<MeasuredBrdf> read() {
    GONIO_TRY(read_word("Source", {}));
    GONIO_TRY(read_word("Symmetry",
                        {"PlaneSymmetrical", "Asymmetrical", "ASymmetrical", "Asymmetrical4D", "ASymmetrical4D"}));
    is_mirrored_ = word_ == "PlaneSymmetrical";
    GONIO_TRY(read_word("SpectralContent", {"Monochrome", "XYZ"}));
    const bool is_colour = word_ == "XYZ";
    GONIO_TRY(read_word("ScatterType", {"BRDF"}));
    GONIO_TRY(read_axis("SampleRotation", -360.0, 360.0, rotations_));
    GONIO_TRY(read_axis("AngleOfIncidence", 0.0, 90.0, incidences_));
    GONIO_TRY(read_axis("ScatterAzimuth", 0.0, 360.0, azimuths_));
    GONIO_TRY(read_axis("ScatterRadial", 0.0, 180.0, radials_));
    if (is_colour) {
      for (const char* name : {"X", "Y", "Z"}) GONIO_TRY(read_channel(name, std::string("Tristimulus") + name));
    } else {
      GONIO_TRY(read_channel("", "Monochrome"));
    }
    if (padded_ > 0)
      brdf_.metadata.remarks.emplace_back("left out", fmt::format("{} zeros that fill rows up to their ends", padded_));
    if (is_mirrored_) brdf_.metadata.symmetry = reflectance::TableSymmetry::Isotropic;
    if (!is_mirrored_ && rotations_.size() == 1) brdf_.metadata.symmetry = reflectance::TableSymmetry::Turn;
    GONIO_TRY(check(brdf_, lines_.file()));
    return std::move(brdf_);
  }

 private:
  std::optional<std::string_view> next_line() {
    while (const std::optional<std::string_view> line = lines_.next()) {
      const std::string_view filled = trimmed(*line);
      if (filled.starts_with('#')) {
        keep_comment(filled, brdf_.metadata);
      } else if (!filled.empty()) {
        return filled;
      }
    }
    return std::nullopt;
  }

  Result<std::string_view> value_of(std::string_view key) {
    const std::optional<std::string_view> line = next_line();
    if (!line) return failure(lines_.error(std::string(key), "the file ends"));
    const auto [found, rest] = key_and_rest(*line);
    if (found == key) return rest;
    return failure(lines_.error(std::string(key), fmt::format("'{}'", found.substr(0, 40)), std::string(key)));
  }

  Result<void> read_word(std::string_view key, const std::vector<std::string_view>& choices) {
    const Result<std::string_view> value = value_of(key);
    if (!value) return failure(value.error());
    word_ = *value;
    if (choices.empty() || std::ranges::count(choices, word_) > 0) return {};
    return failure(lines_.error(std::string(key), fmt::format("'{}'", word_.substr(0, 40)),
                                fmt::format("{}", fmt::join(choices, ", "))));
  }

  Result<void> read_axis(std::string_view key, double least, double most, std::vector<double>& axis) {
    constexpr std::size_t kMostOfAnAxis = 100'000;
    const Result<std::string_view> value = value_of(key);
    if (!value) return failure(value.error());
    const Result<std::size_t> count = lines_.whole(*value, key, 1, kMostOfAnAxis);
    if (!count) return failure(count.error());
    const std::optional<std::string_view> line = next_line();
    if (!line) return failure(lines_.error(std::string(key), "the file ends"));
    Result<std::vector<double>> numbers = lines_.numbers(*line, key, *count);
    if (!numbers) return failure(numbers.error());
    axis = *std::move(numbers);
    const bool is_within = std::ranges::all_of(axis, [&](double v) { return v >= least && v <= most; });
    if (is_within) return {};
    return failure(lines_.error(std::string(key), "an angle out of range", fmt::format("{} to {} deg", least, most)));
  }

  Result<void> read_channel(const std::string& name, const std::string& title) {
    const std::optional<std::string_view> line = next_line();
    if (!line || *line != title)
      return failure(lines_.error(title, line ? fmt::format("'{}'", line->substr(0, 40)) : "the file ends", title));
    GONIO_TRY(value_of("DataBegin"));
    const auto channel = static_cast<std::uint32_t>(brdf_.channels.size());
    brdf_.channels.push_back({.name = name});
    for (const double rotation : rotations_)
      for (const double incidence : incidences_) GONIO_TRY(read_block(rotation, incidence, channel));
    const Result<std::string_view> end = value_of("DataEnd");
    if (!end) return failure(end.error());
    return {};
  }

  Result<void> read_block(double rotation, double incidence, std::uint32_t channel) {
    const Result<std::string_view> tis = value_of("TIS");
    if (!tis) return failure(tis.error());
    const Result<double> total = lines_.number(*tis, "TIS");
    if (!total) return failure(total.error());
    for (std::size_t row = 0; row < azimuths_.size(); ++row) {
      const std::optional<std::string_view> line = next_line();
      if (!line) return failure(lines_.error("", "the file ends within its values"));
      const Result<std::vector<double>> values = lines_.numbers(*line, "values", radials_.size());
      if (!values) return failure(values.error());
      if (brdf_.points.size() + values->size() > kMostPoints)
        return failure(lines_.error("", "too many values", fmt::format("{} points", kMostPoints)));
      const std::size_t filled = filled_part(*values);
      for (std::size_t n = 0; n < radials_.size(); ++n) {
        if (radials_[n] == 0.0 && row > 0) continue;
        if (n < filled) add_point(rotation, incidence, azimuths_[row], radials_[n], (*values)[n], channel);
      }
      padded_ += values->size() - filled;
    }
    return {};
  }

  // Up to the last value that is not 0: rows are filled up with it, where the horizon or the instrument's reach ends
  // them. A row of nothing else is a row of values.
  static std::size_t filled_part(const std::vector<double>& row) {
    const auto last = std::find_if(row.rbegin(), row.rend(), [](double f) { return f != 0.0; });
    return last == row.rend() ? row.size() : static_cast<std::size_t>(row.rend() - last);
  }

  // Directions below the horizon stand in the table, too.
  void add_point(double rotation, double incidence, double azimuth, double radial, double f, std::uint32_t channel) {
    const Result<DirectionPair> d = reflectance::from_specular_centred({.theta_i = degrees(incidence),
                                                                        .phi_i = degrees(-rotation),
                                                                        .radial = degrees(radial),
                                                                        .azimuth = degrees(azimuth)});
    if (!d) return;
    constexpr double kAtTheHorizon = 1e-9;
    if (d->r.mu() < kAtTheHorizon) return;
    BrdfPoint point{.theta_i_deg = incidence,
                    .phi_i_deg = plain_azimuth_deg(-rotation),
                    .theta_r_deg = in_degrees(d->r.theta()),
                    .phi_r_deg = plain_azimuth_deg(in_degrees(d->r.phi())),
                    .f_per_sr = f};
    point.channel = channel;
    brdf_.points.push_back(point);
  }

  TextLines lines_;
  std::string_view word_;
  bool is_mirrored_ = false;
  std::vector<double> rotations_;
  std::vector<double> incidences_;
  std::vector<double> azimuths_;
  std::vector<double> radials_;
  std::size_t padded_ = 0;
  MeasuredBrdf brdf_;
};

}  // namespace

Result<MeasuredBrdf> read_zemax(std::string_view text, const std::string& file) {
  return ZemaxReader(text, file).read();
}

}  // namespace gonio::formats
