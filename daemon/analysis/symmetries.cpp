// Reciprocity, left and right, turns: the pairs of a scan that should agree.
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "daemon/analysis/comparisons.h"
#include "daemon/analysis/plot_deviations.h"
#include "reflectance/check/symmetry_check.h"

namespace gonio::analysis {
namespace {

using reflectance::MeasuredScan;
using reflectance::Sameness;
using reflectance::Symmetry;
using reflectance::SymmetryGap;
using reflectance::SymmetryReport;
using reflectance::TableSymmetry;

constexpr double kDoubtful = 1e-3;  // p value, as calibration's checks have it

struct NamedSymmetry {
  Symmetry symmetry;
  std::string_view name;
  std::string_view claim;
  bool needs_isotropy;
};
constexpr std::array<NamedSymmetry, 3> kSymmetries{
    {{Symmetry::Reciprocity, "reciprocity", "f(i, r) = f(r, i)", false},
     {Symmetry::LeftRight, "left-right", "f(φ) = f(-φ)", true},
     {Symmetry::Turn, "turns", "f is the same under turns about the normal", true}}};

// Table symmetry says what the sample is taken for.
Sameness sameness_for(const NamedSymmetry& wanted, TableSymmetry symmetry) {
  if (symmetry == TableSymmetry::Anisotropic) return Sameness::Exact;
  return wanted.symmetry == Symmetry::Reciprocity ? Sameness::TurnedOrMirrored : Sameness::Turned;
}

void add_symmetry_facts(Told& told, const NamedSymmetry& wanted, const SymmetryReport& report) {
  const std::string name(wanted.name);
  told.facts.push_back(
      {.name = name + " pairs",
       .value = static_cast<double>(report.gaps.size()),
       .unit = "1",
       .note = fmt::format("{} points without a partner, {} that are their own", report.unpaired, report.trivial)});
  if (report.gaps.empty()) return;
  told.facts.push_back({.name = name + " chi-square",
                        .value = report.chi2,
                        .unit = "1",
                        .note = fmt::format("{} degrees of freedom, correlations kept", report.degrees_of_freedom)});
  told.facts.push_back({.name = name + " p value",
                        .value = report.p_value,
                        .unit = "1",
                        .note = report.p_value < kDoubtful
                                    ? "does not hold: angles are off, light strays, the sample is tilted, or u is too "
                                      "small"
                                    : std::string(wanted.claim)});
  told.facts.push_back({.name = name + " worst z",
                        .value = report.worst()->z,
                        .unit = "u",
                        .note = fmt::format("{:.3g} sr^-1", in_per_steradian(report.worst()->difference))});
}

std::string directions_text(const Geometry& g) {
  return fmt::format("{:.6f},{:.6f},{:.6f},{:.6f}", in_degrees(g.theta_i), in_degrees(g.phi_i), in_degrees(g.theta_r),
                     in_degrees(g.phi_r));
}

std::string pair_lines(const NamedSymmetry& wanted, const std::vector<reflectance::SymmetryPoint>& points,
                       const SymmetryReport& report) {
  std::string lines;
  for (const SymmetryGap& gap : report.gaps) {
    const auto& a = points[gap.first];
    const auto& b = points[gap.second];
    lines += fmt::format("{},{},{},{:.8g},{:.8g},{:.8g},{:.4g},{:.4g}\n", wanted.name, directions_text(a.geometry),
                         directions_text(b.geometry), in_per_steradian(a.value), in_per_steradian(b.value),
                         in_per_steradian(gap.difference), in_per_steradian(gap.u), gap.z);
  }
  return lines;
}

Picture pairs_picture(const NamedSymmetry& wanted, const MeasuredScan& scan,
                      const std::vector<reflectance::SymmetryPoint>& points, const SymmetryReport& report,
                      const std::string& stem) {
  DeviationsView view{.stem = stem,
                      .name = std::string(wanted.name),
                      .title = fmt::format("{}: {}", scan.name, wanted.claim),
                      .caption = fmt::format("How well the scan keeps {}: each pair's difference in units of the u of "
                                             "what does not cancel; within 2 lie 95.45 % if it holds.",
                                             wanted.name),
                      .label = "difference / u",
                      .is_in_u = true,
                      .points = {}};
  for (const SymmetryGap& gap : report.gaps) {
    view.points.push_back({.geometry = points[gap.first].geometry, .value = gap.z});
  }
  return deviations_picture(view);
}

}  // namespace

Result<Told> symmetries_told(const MeasuredScan& scan, const std::string& stem) {
  GONIO_TRY(reflectance::check(scan));
  const reflectance::ScanSymmetryPoints all = reflectance::symmetry_points(scan);
  Told told;
  std::string table =
      "symmetry,theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,other_theta_i_deg,other_phi_i_deg,other_theta_r_deg,"
      "other_phi_r_deg,first_per_sr,second_per_sr,difference_per_sr,u_per_sr,z\n";
  for (const NamedSymmetry& wanted : kSymmetries) {
    if (wanted.needs_isotropy && scan.symmetry == TableSymmetry::Anisotropic) {
      told.notes.push_back(fmt::format("{}: not asked of a sample that is not declared isotropic", wanted.name));
      continue;
    }
    const auto report =
        reflectance::check_symmetry(wanted.symmetry, all.points, {.sameness = sameness_for(wanted, scan.symmetry)});
    if (!report) return failure(report.error());
    add_symmetry_facts(told, wanted, *report);
    table += pair_lines(wanted, all.points, *report);
    if (!report->gaps.empty()) told.pictures.push_back(pairs_picture(wanted, scan, all.points, *report, stem));
  }
  told.texts.emplace_back("-pairs.csv", std::move(table));
  return told;
}

}  // namespace gonio::analysis
