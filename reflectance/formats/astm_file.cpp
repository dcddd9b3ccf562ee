#include "reflectance/formats/astm_file.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "reflectance/formats/text_lines.h"
#include "reflectance/formats/writer_losses.h"

namespace gonio::formats {
namespace {

constexpr std::array<std::string_view, 4> kAstmAngles{"theta_i", "phi_i", "theta_s", "phi_s"};
constexpr double kRadian = std::numbers::pi / 180.0;  // a degree in them

std::string astm_header(const MeasuredBrdf& brdf, std::size_t channel, std::size_t points) {
  const BrdfMetadata& m = brdf.metadata;
  std::string text = "ASTM E1392-96(2002)\n";
  const auto put = [&text](std::string_view key, const std::string& value) {
    if (!value.empty()) text += fmt::format("{} {}\n", key, one_line(value));
  };
  put("SAMPLE", m.sample);
  put("DESCRIPTION", m.description);
  put("DATE", m.measured_at);
  put("INSTRUMENT", m.instrument);
  put("OPERATOR", m.operator_name);
  put("NUM_POINTS", std::to_string(points));
  std::string name = brdf.channels[channel].name.empty() ? "BRDF" : one_line(brdf.channels[channel].name);
  std::ranges::replace(name, ',', ' ');
  return text + fmt::format("VARS {},{}\n", fmt::join(kAstmAngles, ","), name);
}

// pi/2 as a float or in seven digits lies a little below the horizon.
double theta_deg(double theta) {
  constexpr double kHorizon = 90.0;
  constexpr double kRounding = 1e-4;
  const double angle = theta / kRadian;
  return angle > kHorizon && angle < kHorizon + kRounding ? kHorizon : angle;
}

Channel astm_channel(std::string_view name, const TextLines& lines) {
  Channel channel{.name = std::string(name)};
  if (!name.ends_with("nm")) return channel;
  const Result<double> wavelength = lines.number(name.substr(0, name.size() - 2), "VARS");
  if (wavelength && *wavelength > 0.0) channel.wavelength_nm = *wavelength;
  return channel;
}

// Between commas; some write blanks.
std::vector<std::string_view> cells_of(std::string_view line) {
  return line.find(',') == std::string_view::npos ? words(line) : split(line, ',');
}

// The standard's scattered direction is called reflected by some.
bool is_angle_name(std::string_view name, std::size_t place) {
  constexpr std::array<std::string_view, 4> kReflected{"theta_i", "phi_i", "theta_r", "phi_r"};
  return name == kAstmAngles[place] || name == kReflected[place];
}

class AstmReader {
 public:
  AstmReader(std::string_view text, const std::string& file) : lines_(text, "ASTM text", file) {}

  Result<MeasuredBrdf> read() {
    GONIO_TRY(read_header());
    std::size_t rows = 0;
    while (const std::optional<std::string_view> line = lines_.next()) {
      if (trimmed(*line).empty()) continue;
      GONIO_TRY(read_row(*line));
      ++rows;
    }
    GONIO_TRY(lines_.check_end());
    if (points_ && rows != *points_)
      return failure(lines_.error("NUM_POINTS", fmt::format("{} lines", rows), fmt::format("{}", *points_)));
    GONIO_TRY(check(brdf_, lines_.file()));
    return std::move(brdf_);
  }

 private:
  Result<void> read_header() {
    while (const std::optional<std::string_view> line = lines_.next()) {
      const auto [key, rest] = key_and_rest(*line);
      if (key == "VARS") return read_names(rest);
      GONIO_TRY(read_header_line(key, rest));
    }
    return failure(lines_.error("VARS", "the line is absent", "VARS theta_i,phi_i,theta_s,phi_s,..."));
  }

  Result<void> read_header_line(std::string_view key, std::string_view rest) {
    BrdfMetadata& m = brdf_.metadata;
    if (key == "NUM_POINTS") {
      const Result<std::size_t> points = lines_.whole(rest, "NUM_POINTS", 0, kMostPoints);
      if (!points) return failure(points.error());
      points_ = *points;
    } else if (key == "SAMPLE") {
      m.sample = rest;
    } else if (key == "DESCRIPTION") {
      m.description = rest;
    } else if (key == "DATE") {
      m.measured_at = rest;
    } else if (key == "INSTRUMENT") {
      m.instrument = rest;
    } else if (key == "OPERATOR") {
      m.operator_name = rest;
    } else if (!key.empty() && key != "ASTM") {
      m.remarks.emplace_back(key, rest);
    }
    return {};
  }

  Result<void> read_names(std::string_view rest) {
    const std::vector<std::string_view> names = cells_of(rest);
    if (names.size() <= kAstmAngles.size())
      return failure(lines_.error("VARS", fmt::format("{} columns", names.size()), "four angles and a value"));
    for (std::size_t n = 0; n < kAstmAngles.size(); ++n) {
      if (!is_angle_name(trimmed(names[n]), n))
        return failure(lines_.error("VARS", fmt::format("column {} is '{}'", n + 1, names[n].substr(0, 40)),
                                    std::string(kAstmAngles[n])));
    }
    for (std::size_t n = kAstmAngles.size(); n < names.size(); ++n)
      brdf_.channels.push_back(astm_channel(trimmed(names[n]), lines_));
    return {};
  }

  Result<void> read_row(std::string_view line) {
    const std::vector<std::string_view> cells = cells_of(line);
    const std::size_t wanted = kAstmAngles.size() + brdf_.channels.size();
    if (cells.size() != wanted)
      return failure(lines_.error("", fmt::format("{} cells", cells.size()), fmt::format("{}", wanted)));
    BrdfPoint point;
    constexpr std::array kFields{&BrdfPoint::theta_i_deg, &BrdfPoint::phi_i_deg, &BrdfPoint::theta_r_deg,
                                 &BrdfPoint::phi_r_deg};
    for (std::size_t n = 0; n < cells.size(); ++n) {
      const bool is_angle = n < kFields.size();
      const Result<double> value = lines_.number(
          cells[n], is_angle ? kAstmAngles[n] : std::string_view(brdf_.channels[n - kFields.size()].name));
      if (!value) return failure(value.error());
      if (is_angle) {
        point.*kFields[n] = n % 2 == 0 ? theta_deg(*value) : *value / kRadian;
        continue;
      }
      point.channel = static_cast<std::uint32_t>(n - kFields.size());
      point.f_per_sr = *value;
      brdf_.points.push_back(point);
    }
    return {};
  }

  TextLines lines_;
  std::optional<std::size_t> points_;
  MeasuredBrdf brdf_;
};

}  // namespace

Result<Export> write_astm(const MeasuredBrdf& brdf) {
  GONIO_TRY(check(brdf, "ASTM text"));
  Export written;
  written.losses = losses_of_bare_values(brdf);
  for (std::size_t channel = 0; channel < brdf.channels.size(); ++channel) {
    std::string rows;
    std::size_t count = 0;
    for (const BrdfPoint& point : brdf.points) {
      if (point.channel != channel) continue;
      const BrdfPoint p = in_plain_ranges(point);
      rows += fmt::format("{},{},{},{},{}\n", p.theta_i_deg * kRadian, p.phi_i_deg * kRadian, p.theta_r_deg * kRadian,
                          p.phi_r_deg * kRadian, p.f_per_sr);
      ++count;
    }
    if (count == 0) continue;
    written.files.push_back(
        {.suffix = channel_suffix(brdf, channel) + ".astm", .bytes = astm_header(brdf, channel, count) + rows});
  }
  return written;
}

Result<MeasuredBrdf> read_astm(std::string_view text, const std::string& file) {
  return AstmReader(text, file).read();
}

}  // namespace gonio::formats
