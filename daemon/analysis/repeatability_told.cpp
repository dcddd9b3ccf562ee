// Several scans of one sample: what scatters between them and within them.
#include <cmath>

#include <fmt/format.h>

#include "daemon/analysis/comparisons.h"
#include "reflectance/measured/repeatability.h"

namespace gonio::analysis {
namespace {

using reflectance::MeasuredScan;
using reflectance::Repeatability;
using reflectance::RepeatedPoint;

constexpr double kInPercent = 100.0;

// Root mean square of scatter / u: 1 where u is true.
double scatter_in_u(const Repeatability& r) {
  double squares = 0.0;
  double freedom = 0.0;
  for (const RepeatedPoint& p : r.points) {
    const auto dof = static_cast<double>(p.count - 1);
    squares += dof * (p.scatter / p.u) * (p.scatter / p.u);
    freedom += dof;
  }
  return std::sqrt(squares / freedom);
}

std::vector<api::AnalysisFact> repeatability_facts(const Repeatability& r) {
  std::vector<api::AnalysisFact> facts{
      {.name = "points of several scans", .value = static_cast<double>(r.points.size()), .unit = "1", .note = ""},
      {.name = "spread of a point",
       .value = kInPercent * r.relative_scatter,
       .unit = "%",
       .note = "standard deviation of one value about the mean of its geometry, pooled"},
      {.name = "of it between scans",
       .value = kInPercent * r.relative_between,
       .unit = "%",
       .note = "standard deviation of the scans' mean offsets"},
      {.name = "of it within scans",
       .value = kInPercent * r.relative_within,
       .unit = "%",
       .note = "with each scan's mean offset taken out"},
      {.name = "spread over stated u",
       .value = scatter_in_u(r),
       .unit = "1",
       .note = "root mean square; u of what a scan draws anew: 1 where it is true"},
      {.name = "chi-square",
       .value = r.chi2,
       .unit = "1",
       .note = fmt::format("{} degrees of freedom; what all scans share cancels", r.degrees_of_freedom)},
      {.name = "p value", .value = r.p_value, .unit = "1", .note = "of a larger chi-square by chance"}};
  for (const reflectance::ScanOffset& scan : r.scans) {
    facts.push_back({.name = "mean offset of " + scan.name,
                     .value = kInPercent * scan.mean_offset,
                     .unit = "%",
                     .note = fmt::format("from the means of {} geometries", scan.points)});
  }
  return facts;
}

std::string repeatability_table(const Repeatability& r) {
  std::string table =
      "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,scans,mean_per_sr,spread_per_sr,u_random_per_sr,u_per_sr,U_per_sr,"
      "spread_over_u\n";
  for (const RepeatedPoint& p : r.points) {
    const Geometry& g = p.geometry;
    table += fmt::format("{:.6f},{:.6f},{:.6f},{:.6f},{},{:.8g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g}\n",
                         in_degrees(g.theta_i), in_degrees(g.phi_i), in_degrees(g.theta_r), in_degrees(g.phi_r),
                         p.count, in_per_steradian(p.mean), in_per_steradian(p.scatter), in_per_steradian(p.u_random),
                         in_per_steradian(p.u), 2.0 * in_per_steradian(p.u), p.scatter / p.u);
  }
  return table;
}

// Left: spread and stated u of each point; right: the scans' offsets.
Picture repeatability_picture(const Repeatability& r, const std::string& stem) {
  Picture picture{.name = "spread", .caption = {}, .script = {}, .tables = {}};
  picture.caption =
      "The spread of each point over the scans beside the u that each scan states of what it draws anew, by phase "
      "angle; and how far each scan lies from the mean of all.";
  picture.width_px = 1200;
  picture.height_px = 480;
  std::string points = "# phase_deg spread_percent u_percent\n";
  for (const RepeatedPoint& p : r.points) {
    if (std::abs(p.mean.si()) <= 3.0 * p.u_random.si()) continue;
    const double mean = std::abs(in_per_steradian(p.mean));
    points += fmt::format("{:.5g} {:.5g} {:.5g}\n", in_degrees(phase_angle(p.geometry)),
                          kInPercent * in_per_steradian(p.scatter) / mean, kInPercent * in_per_steradian(p.u) / mean);
  }
  std::string scans = "# place offset_percent name\n";
  for (std::size_t k = 0; k < r.scans.size(); ++k) {
    scans += fmt::format("{} {:.5g} \"{}\"\n", k + 1, kInPercent * r.scans[k].mean_offset, r.scans[k].name);
  }
  const std::string points_name = stem + "-spread.dat";
  const std::string scans_name = stem + "-offsets.dat";
  picture.tables = {{points_name, std::move(points)}, {scans_name, std::move(scans)}};
  picture.script = fmt::format(
      "set multiplot layout 1,2 title 'Repeatability of {2} scans' font ',15'\nset grid lc rgb '#dddddd'\n"
      "set xlabel 'phase angle ξ [°]'; set ylabel 'of the point''s mean [%]'; set yrange [0:*]\n"
      "plot {0} using 1:2 with points pt 7 ps 0.6 lc rgb '#31688e' title 'spread over the scans', {0} using 1:3 with "
      "points pt 1 ps 0.8 lc rgb '#d62728' title 'u of a scan, k = 1'\n"
      "unset key; set yrange [*:*]; set xrange [0.5:{3}]; set xlabel ''; set ylabel 'mean offset of the scan [%]'; set "
      "xtics rotate by -30\nset xzeroaxis lc rgb '#888888'\n"
      "plot {1} using 1:2:xtic(3) with impulses lw 6 lc rgb '#31688e'\nunset multiplot\n",
      in_quotes(points_name), in_quotes(scans_name), r.scans.size(), static_cast<double>(r.scans.size()) + 0.5);
  return picture;
}

}  // namespace

Result<Told> repeatability_told(const std::vector<MeasuredScan>& scans, const std::string& stem) {
  const auto repeated = reflectance::repeatability(scans);
  if (!repeated) return failure(repeated.error());
  return Told{.facts = repeatability_facts(*repeated),
              .notes = {},
              .texts = {{".csv", repeatability_table(*repeated)}},
              .pictures = {repeatability_picture(*repeated, stem)}};
}

}  // namespace gonio::analysis
