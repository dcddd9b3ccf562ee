#include <algorithm>
#include <iterator>
#include <span>

#include <fmt/format.h>

#include "reflectance/formats/ssdd_file.h"
#include "reflectance/formats/text_lines.h"

namespace gonio::formats {
namespace {

using reflectance::Direction;
using reflectance::TableSymmetry;

Result<void> check_ssdd_axis(std::string_view name, const std::vector<double>& values, double most) {
  // Not "at least": NaN must not pass.
  const auto does_not_rise = [](double a, double b) { return !(a < b); };
  const bool rises = std::ranges::adjacent_find(values, does_not_rise) == values.end();
  if (rises && !values.empty() && values.front() >= 0.0 && values.back() <= most) return {};
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = "write SSDD",
                  .seen = fmt::format("{} values of {}", values.size(), name),
                  .limit = fmt::format("rising, 0 to {} deg", most)});
}

std::string day_of(const std::string& iso8601) {
  constexpr std::size_t kDay = 10;
  return iso8601.substr(0, kDay);
}

std::string ssdd_header(const SurfaceFile& file, std::span<const ChannelSurface> channels, const SsddAxes& axes) {
  std::string text = "VERSION 0.2\n";
  const bool is_spectrum = channels.size() > 1;
  text += fmt::format("DATA_TYPE brdf\nCOLOR_MODEL {}\n", is_spectrum ? "spectrum" : "monochrome");
  if (is_spectrum) {
    text += "WAVELENGTH_LIST";
    for (const ChannelSurface& one : channels) text += " " + number_text(one.channel.wavelength_nm);
    text += '\n';
  }
  text += "PARAM_TYPE spherical_coordinate_system\n";
  if (axes.phi_r.back() <= 180.0 && axes.phi_r.size() > 1) text += "REDUCTION_TYPE bilateral_symmetry\n";
  text += fmt::format("PARAM0_LIST {}\n", fmt::join(axes.theta_i, " "));
  if (axes.phi_i.size() > 1) text += fmt::format("PARAM1_LIST {}\n", fmt::join(axes.phi_i, " "));
  text += fmt::format("PARAM2_LIST {}\nPARAM3_LIST {}\n", fmt::join(axes.theta_r, " "), fmt::join(axes.phi_r, " "));
  if (!file.metadata.sample.empty()) text += fmt::format("NAME {}\n", one_line(file.metadata.sample));
  text += fmt::format("SOURCE_TYPE {}\n", file.metadata.method == Method::Simulation ? "generated" : "measured");
  if (!file.metadata.instrument.empty()) text += fmt::format("DEVICE {}\n", one_line(file.metadata.instrument));
  if (!file.metadata.measured_at.empty())
    text += fmt::format("MEASUREMENT_DATE {}\n", day_of(one_line(file.metadata.measured_at)));
  return text + "DATA ascii\n";
}

std::string ssdd_text(const SurfaceFile& file, std::span<const ChannelSurface> channels, const SsddAxes& axes,
                      Losses& losses) {
  std::string text = ssdd_header(file, channels, axes);
  std::vector<GridReader> values;
  for (const ChannelSurface& one : channels) values.emplace_back(one);
  for (const double phi_r : axes.phi_r) {
    for (const double theta_r : axes.theta_r) {
      for (const double phi_i : axes.phi_i) {
        for (const double theta_i : axes.theta_i) {
          const Direction i = Direction::from_angles(degrees(theta_i), degrees(phi_i));
          const Direction r = Direction::from_angles(degrees(theta_r), degrees(phi_r));
          std::string_view gap;
          for (GridReader& value : values) {
            text.append(gap).append(number_text(value.at(i, r)));
            gap = " ";
          }
          text += '\n';
        }
      }
    }
  }
  for (const GridReader& value : values) value.add_losses(losses);
  return text;
}

bool has_spectrum(const SurfaceFile& file) {
  const auto not_rising = [](const ChannelSurface& a, const ChannelSurface& b) {
    return a.channel.wavelength_nm >= b.channel.wavelength_nm;
  };
  return file.channels.front().channel.wavelength_nm > 0.0 &&
         std::ranges::adjacent_find(file.channels, not_rising) == file.channels.end();
}

// The values closer than 1e-9 deg are one: decimals of a file do not repeat to the last digit.
std::vector<double> distinct(std::vector<double> values) {
  constexpr double kSameAngle = 1e-9;
  std::ranges::sort(values);
  std::vector<double> found;
  for (const double value : values)
    if (found.empty() || value - found.back() > kSameAngle) found.push_back(value);
  return found;
}

}  // namespace

Result<Export> write_ssdd(const SurfaceFile& file, const SsddAxes& axes) {
  constexpr double kHorizon = 90.0;
  constexpr double kTurn = 360.0;
  constexpr double kStep = 5.0;
  GONIO_TRY(check(file, "SSDD"));
  SsddAxes own = axes;
  const bool is_isotropic =
      std::ranges::all_of(file.channels, [](const ChannelSurface& one) { return one.surface.is_isotropic(); });
  if (own.phi_r.empty())
    for (double phi = 0.0; phi <= (is_isotropic ? 0.5 * kTurn : kTurn); phi += kStep) own.phi_r.push_back(phi);
  GONIO_TRY(check_ssdd_axis("theta_i", own.theta_i, kHorizon));
  GONIO_TRY(check_ssdd_axis("phi_i", own.phi_i, kTurn));
  GONIO_TRY(check_ssdd_axis("theta_r", own.theta_r, kHorizon));
  GONIO_TRY(check_ssdd_axis("phi_r", own.phi_r, kTurn));
  Export written{.files = {}, .losses = file.losses};
  if (file.channels.size() == 1 || has_spectrum(file)) {
    written.files.push_back({.suffix = ".ssdd", .bytes = ssdd_text(file, file.channels, own, written.losses)});
  } else {
    for (std::size_t n = 0; n < file.channels.size(); ++n)
      written.files.push_back({.suffix = channel_suffix(file, n) + ".ssdd",
                               .bytes = ssdd_text(file, std::span(file.channels).subspan(n, 1), own, written.losses)});
  }
  if (own.phi_i.size() == 1)
    for (const ChannelSurface& one : file.channels) add_anisotropy_loss(written.losses, one.surface);
  return written;
}

SsddAxes ssdd_axes_of(const MeasuredBrdf& brdf) {
  const bool turns = symmetry_of(brdf) != TableSymmetry::Anisotropic;
  std::vector<double> theta_i, phi_i, theta_r, phi_r;
  std::size_t off_pole = 0;
  for (const BrdfPoint& point : brdf.points) {
    const BrdfPoint p = in_plain_ranges(point);
    theta_i.push_back(p.theta_i_deg);
    theta_r.push_back(p.theta_r_deg);
    phi_i.push_back(turns ? 0.0 : p.phi_i_deg);
    if (p.theta_r_deg == 0.0) continue;
    ++off_pole;
    phi_r.push_back(turns ? plain_azimuth_deg(p.phi_r_deg - p.phi_i_deg) : p.phi_r_deg);
  }
  SsddAxes axes{
      .theta_i = distinct(theta_i), .phi_i = distinct(phi_i), .theta_r = distinct(theta_r), .phi_r = distinct(phi_r)};
  const std::size_t rings = axes.theta_r.size() - (axes.theta_r.front() == 0.0 ? 1 : 0);
  const std::size_t whole = axes.theta_i.size() * axes.phi_i.size() * rings * axes.phi_r.size() * brdf.channels.size();
  if (off_pole != whole || axes.phi_r.empty()) return {};
  // A turn is closed where it is one, for readers that interpolate.
  constexpr double kHalfTurn = 180.0;
  if (axes.phi_r.front() == 0.0 && axes.phi_r.back() > kHalfTurn) axes.phi_r.push_back(2.0 * kHalfTurn);
  return axes;
}

}  // namespace gonio::formats
