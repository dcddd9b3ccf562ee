// BRDF files of any format but HDF5, whose parser is not ours: a reader takes what it can stand by, or says what is
// wrong and where. What was taken is written as CSV and read again to the bit, and is a surface or has its word.
#include <cmath>

#include "reflectance/formats/csv_file.h"
#include "reflectance/formats/format.h"
#include "reflectance/formats/surface_file.h"
#include "reflectance/table/tabulated_surface.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

constexpr std::size_t kMostForASurface = 2000;  // points: larger ones only take longer

void hold_round_trip(const formats::MeasuredBrdf& brdf) {
  const auto written = formats::write_csv(brdf);
  if (!written) {  // a flag's name that a CSV cannot hold
    hold_error(written.error());
    return;
  }
  const auto again = formats::read_csv(written->files.at(0).bytes, written->files.at(1).bytes, "again.csv");
  hold(again.has_value(), "what was written is read: " + (again ? "" : describe(again.error())));
  hold(*again == brdf, "our own format loses nothing");
}

void hold_surface(const formats::MeasuredBrdf& brdf) {
  const auto surfaces = formats::surfaces_of(brdf);
  if (!surfaces) {
    hold_error(surfaces.error());
    return;
  }
  for (const formats::ChannelSurface& channel : surfaces->channels) {
    double least = 0.0;
    double most = 0.0;
    for (const formats::BrdfPoint& p : brdf.points) {
      least = std::min(least, p.f_per_sr);
      most = std::max(most, p.f_per_sr);
    }
    const double rounding = 1e-9 * (most - least);
    for (const auto& [theta_i, theta_r, phi_r] : {std::array{0.0, 0.0, 0.0}, {30.0, 30.0, 0.0}, {60.0, 89.0, 123.0}}) {
      const Geometry g{.theta_i = degrees(theta_i), .phi_i = {}, .theta_r = degrees(theta_r), .phi_r = degrees(phi_r)};
      const double f = in_per_steradian(channel.surface.eval(g));
      hold(std::isfinite(f), "a surface is finite");
      hold(f >= least - rounding && f <= most + rounding, "a table stays within its readings");
    }
  }
}

}  // namespace

void brdf_file(Bytes input) {
  const std::string_view bytes = text_of(input);
  const auto format = formats::detect_format(bytes);
  if (format == formats::Format::Nexus) return;
  const auto brdf = formats::read_brdf(bytes, "some.file");
  if (!brdf) {
    hold_error(brdf.error());
    hold(brdf.error().where && brdf.error().where->file == "some.file", "a file's error names the file");
    return;
  }
  hold(format.has_value() && formats::is_readable(*format), "what was read is known");
  hold(formats::check(*brdf, "some.file").has_value(), "a reader ends with the check");
  if (brdf->points.size() > kMostForASurface) return;
  hold_round_trip(*brdf);
  hold_surface(*brdf);
}

}  // namespace gonio::fuzz
