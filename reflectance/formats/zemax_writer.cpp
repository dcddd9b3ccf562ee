#include <algorithm>

#include <fmt/format.h>

#include "reflectance/convention/specular_centred_angles.h"
#include "reflectance/formats/text_lines.h"
#include "reflectance/formats/zemax_file.h"
#include "reflectance/integral/directional_reflectance.h"

namespace gonio::formats {
namespace {

using reflectance::Direction;
using reflectance::DirectionPair;

constexpr double kZemaxTolerance = 1e-3;  // of TIS

Result<void> check_axis(std::string_view name, const std::vector<double>& values, double most) {
  // Not "at least": NaN must not pass.
  const auto does_not_rise = [](double a, double b) { return !(a < b); };
  const bool rises = std::ranges::adjacent_find(values, does_not_rise) == values.end();
  const bool is_within = !values.empty() && values.front() >= 0.0 && values.back() <= most;
  if (rises && is_within) return {};
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = "write Zemax text",
                  .seen = fmt::format("{} values of {}", values.size(), name),
                  .limit = fmt::format("rising, 0 to {} deg", most)});
}

std::string axis_text(std::string_view key, const std::vector<double>& values) {
  return fmt::format("{}\t{}\n{}\n", key, values.size(), fmt::join(values, "\t"));
}

std::string block(GridReader& values, double incidence, const ZemaxAxes& axes) {
  std::string text;
  for (const double azimuth : axes.azimuths) {
    std::string_view gap;
    for (const double radial : axes.radials) {
      const Result<DirectionPair> d = reflectance::from_specular_centred(
          {.theta_i = degrees(incidence), .phi_i = {}, .radial = degrees(radial), .azimuth = degrees(azimuth)});
      text += fmt::format("{}{:.6e}", gap, d ? values.at_least_zero(d->i, d->r) : 0.0);
      gap = "\t";
    }
    text += '\n';
  }
  return text;
}

std::string zemax_text(const SurfaceFile& file, const ChannelSurface& one, const ZemaxAxes& axes, Losses& losses) {
  std::string text =
      fmt::format("# Sample: {}\n# Instrument: {}\n# Measured: {}\n# Channel: {}\n", one_line(file.metadata.sample),
                  one_line(file.metadata.instrument), one_line(file.metadata.measured_at), one_line(one.channel.name));
  const bool is_symmetrical = axes.azimuths.back() <= 180.0;
  text += fmt::format("Source\tMeasured\nSymmetry\t{}\nSpectralContent\tMonochrome\nScatterType\tBRDF\n",
                      is_symmetrical ? "PlaneSymmetrical" : "Asymmetrical");
  text += axis_text("SampleRotation", {0.0}) + axis_text("AngleOfIncidence", axes.incidences) +
          axis_text("ScatterAzimuth", axes.azimuths) + axis_text("ScatterRadial", axes.radials) +
          "\nMonochrome\nDataBegin\n";
  GridReader values(one);
  for (const double incidence : axes.incidences) {
    const Direction i = Direction::from_angles(degrees(incidence), Angle{});
    text +=
        fmt::format("TIS\t{:.6f}\n", rho_dh(one.surface, i, kZemaxTolerance).value) + block(values, incidence, axes);
  }
  values.add_losses(losses);
  add_anisotropy_loss(losses, one.surface);
  return text + "DataEnd\n";
}

}  // namespace

Result<Export> write_zemax(const SurfaceFile& file, const ZemaxAxes& axes) {
  constexpr double kStep = 10.0;
  constexpr double kLowest = 89.0;  // light along the surface has no reflectance to speak of
  GONIO_TRY(check(file, "Zemax text"));
  GONIO_TRY(check_axis("AngleOfIncidence", axes.incidences, kLowest));
  GONIO_TRY(check_axis("ScatterRadial", axes.radials, 180.0));
  Export written{.files = {}, .losses = file.losses};
  for (std::size_t n = 0; n < file.channels.size(); ++n) {
    ZemaxAxes own = axes;
    const double turn = file.channels[n].surface.is_isotropic() ? 180.0 : 360.0;
    if (own.azimuths.empty())
      for (double azimuth = 0.0; azimuth <= turn; azimuth += kStep) own.azimuths.push_back(azimuth);
    GONIO_TRY(check_axis("ScatterAzimuth", own.azimuths, 360.0));
    written.files.push_back({.suffix = channel_suffix(file, n) + ".bsdf",
                             .bytes = zemax_text(file, file.channels[n], own, written.losses)});
  }
  return written;
}

}  // namespace gonio::formats
