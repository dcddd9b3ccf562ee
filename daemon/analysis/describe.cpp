#include "daemon/analysis/describe.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "reflectance/formats/surface_file.h"
#include "reflectance/table/cross_validation.h"
#include "reflectance/table/tabulated_surface.h"

namespace gonio::analysis {
namespace {

using api::AnalysisFact;
using formats::BrdfPoint;
using formats::MeasuredBrdf;
using reflectance::CrossValidation;
using reflectance::Direction;
using reflectance::TabulatedSurface;

constexpr std::size_t kIncidencesShown = 6;
constexpr double kTolerance = 1e-4;

AnalysisFact count_fact(std::string name, std::size_t count) {
  return {.name = std::move(name), .value = static_cast<double>(count), .unit = "1"};
}

std::string place_text(const BrdfPoint& p) {
  return fmt::format("at ({:.4g}, {:.4g}; {:.4g}, {:.4g}) deg", p.theta_i_deg, p.phi_i_deg, p.theta_r_deg, p.phi_r_deg);
}

void add_range(std::vector<AnalysisFact>& facts, const MeasuredBrdf& brdf) {
  const auto [least, most] = std::ranges::minmax_element(brdf.points, {}, &BrdfPoint::f_per_sr);
  facts.push_back({.name = "least f_r", .value = least->f_per_sr, .unit = "sr^-1", .note = place_text(*least)});
  facts.push_back({.name = "largest f_r", .value = most->f_per_sr, .unit = "sr^-1", .note = place_text(*most)});
}

void add_validation(std::vector<AnalysisFact>& facts, const std::string& name, const CrossValidation& cv) {
  if (cv.count == 0) return;
  facts.push_back(
      {.name = name,
       .value = in_per_steradian(cv.rms),
       .unit = "sr^-1",
       .note = fmt::format("RMS over {} readings, mean |f| {:.4g}; most {:.3g} at ({:.4g}; {:.4g}, {:.4g}) deg",
                           cv.count, in_per_steradian(cv.mean), in_per_steradian(cv.most), in_degrees(cv.worst.theta_i),
                           in_degrees(cv.worst.theta_r), in_degrees(cv.worst.phi_r))});
}

// Spread over the incidences, first and last among them.
std::vector<std::size_t> shown_of(std::size_t count) {
  std::vector<std::size_t> shown;
  const std::size_t n = std::min(count, kIncidencesShown);
  for (std::size_t i = 0; i < n; ++i) shown.push_back(n == 1 ? 0 : i * (count - 1) / (n - 1));
  return shown;
}

void add_surface(std::vector<AnalysisFact>& facts, const std::string& channel, const TabulatedSurface& table) {
  facts.push_back(count_fact("incidences " + channel, table.report().incidences));
  for (const std::size_t k : shown_of(table.rows().size())) {
    const reflectance::TableRow& row = table.rows()[k];
    const Direction i = Direction::from_angles(row.theta_i(), row.phi_i());
    const reflectance::Integral rho = table.rho_dh(i, kTolerance);
    facts.push_back({.name = fmt::format("rho_dh({:.4g} deg) {}", in_degrees(row.theta_i()), channel),
                     .value = rho.value,
                     .unit = "1",
                     .note = fmt::format("{:.2g} % of its weight not measured", 100.0 * table.extrapolated_share(i))});
  }
  add_validation(facts, "cross-validated views " + channel, cross_validate_views(table));
  if (table.report().incidences > 2) {
    add_validation(facts, "cross-validated incidences " + channel, cross_validate_incidences(table));
  }
}

}  // namespace

Result<std::vector<AnalysisFact>> describe_brdf(const MeasuredBrdf& brdf, std::vector<std::string>& notes) {
  GONIO_TRY(formats::check(brdf, brdf.metadata.sample));
  std::vector<AnalysisFact> facts{count_fact("points", brdf.points.size()),
                                  count_fact("channels", brdf.channels.size())};
  const auto with_u = std::ranges::count_if(brdf.points, [](const BrdfPoint& p) { return p.U_per_sr > 0.0; });
  facts.push_back(count_fact("points with U", static_cast<std::size_t>(with_u)));
  add_range(facts, brdf);
  const Result<formats::SurfaceFile> surfaces = formats::surfaces_of(brdf);
  if (!surfaces) {
    notes.push_back("no surface, so no integral: " + describe(surfaces.error()));
    return facts;
  }
  for (const formats::ChannelSurface& channel : surfaces->channels) {
    if (const auto* table = channel.surface.as<TabulatedSurface>()) add_surface(facts, channel.channel.name, *table);
  }
  return facts;
}

}  // namespace gonio::analysis
