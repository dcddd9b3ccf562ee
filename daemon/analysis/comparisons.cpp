#include "daemon/analysis/comparisons.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "daemon/analysis/plot_deviations.h"
#include "reflectance/check/chi_square.h"
#include "reflectance/measured/compare_scans.h"

namespace gonio::analysis {
namespace {

using api::AnalysisFact;
using reflectance::MeasuredScan;
using reflectance::PointGap;
using reflectance::ScanComparison;

constexpr double kCoverage = 2.0;  // of U, 95.45 %
constexpr double kPercent = 100.0;

std::string place_of(const Geometry& g) {
  return fmt::format("at ({:.4g}; {:.4g}, {:.4g}) deg", in_degrees(g.theta_i), in_degrees(g.theta_r),
                     in_degrees(g.phi_r - g.phi_i));
}

double share_within_u(const ScanComparison& c) {
  const auto held = std::ranges::count_if(c.gaps, [](const PointGap& gap) { return std::abs(gap.z) <= kCoverage; });
  return kPercent * static_cast<double>(held) / static_cast<double>(c.gaps.size());
}

std::vector<AnalysisFact> comparison_facts(const ScanComparison& c) {
  const PointGap& worst = *c.worst();
  return {
      {.name = "points compared", .value = static_cast<double>(c.gaps.size()), .unit = "1", .note = ""},
      {.name = "without a partner",
       .value = static_cast<double>(c.unpaired_first + c.unpaired_second),
       .unit = "1",
       .note = fmt::format("{} of the first, {} of the other", c.unpaired_first, c.unpaired_second)},
      {.name = "chi-square",
       .value = c.chi2,
       .unit = "1",
       .note = fmt::format("{} degrees of freedom, correlations kept", c.degrees_of_freedom)},
      {.name = "p value", .value = c.p_value, .unit = "1", .note = "of a larger chi-square by chance"},
      {.name = "share within U", .value = share_within_u(c), .unit = "%", .note = "95.45 % expected"},
      {.name = "worst z",
       .value = worst.z,
       .unit = "u",
       .note = fmt::format("{:.3g} sr^-1 {}", in_per_steradian(worst.difference), place_of(worst.geometry))},
      {.name = "mean ratio", .value = c.mean_ratio, .unit = "1", .note = "sum of the first over that of the other"}};
}

std::string comparison_table(const MeasuredScan& first, const ScanComparison& c) {
  std::string table =
      "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,first_per_sr,second_per_sr,difference_per_sr,u_per_sr,z,"
      "difference_in_U,u_interpolation_per_sr\n";
  for (const PointGap& gap : c.gaps) {
    const double f = in_per_steradian(first.points[gap.first].value);
    const double difference = in_per_steradian(gap.difference);
    table +=
        fmt::format("{:.6f},{:.6f},{:.6f},{:.6f},{:.8g},{:.8g},{:.8g},{:.8g},{:.4g},{:.4g},{:.8g}\n",
                    in_degrees(gap.geometry.theta_i), in_degrees(gap.geometry.phi_i), in_degrees(gap.geometry.theta_r),
                    in_degrees(gap.geometry.phi_r), f, f - difference, difference, in_per_steradian(gap.u), gap.z,
                    gap.z / kCoverage, in_per_steradian(gap.u_interpolation));
  }
  return table;
}

Told told_of(const MeasuredScan& first, const ScanComparison& c, const std::string& what, const std::string& stem) {
  DeviationsView view{.stem = stem,
                      .name = "differences",
                      .title = first.name + " beside " + what,
                      .caption =
                          "Differences in units of the u of what does not cancel, by phase angle and over the "
                          "directions of view; within 2 lie 95.45 % if both agree.",
                      .label = "difference / u",
                      .is_in_u = true,
                      .points = {}};
  for (const PointGap& gap : c.gaps) view.points.push_back({.geometry = gap.geometry, .value = gap.z});
  return {.facts = comparison_facts(c),
          .notes = {},
          .texts = {{".csv", comparison_table(first, c)}},
          .pictures = {deviations_picture(view)}};
}

// Of one source's effect on the pairs: root mean squares over the first's values, before and after the difference.
struct Cancelled {
  double before = 0.0;
  double after = 0.0;
};

double effect_of(const reflectance::MeasuredPoint& p, std::size_t component) {
  double sum = 0.0;
  for (const reflectance::SharedEffect& e : p.shared) sum += e.component == component ? e.per_sd.si() : 0.0;
  return sum;
}

Cancelled cancelled(const MeasuredScan& first, std::size_t a, const MeasuredScan& second, std::size_t b,
                    const ScanComparison& c) {
  double before = 0.0;
  double after = 0.0;
  double size = 0.0;
  for (const PointGap& gap : c.gaps) {
    const double own = effect_of(first.points[gap.first], a);
    const double left = own - effect_of(second.points[gap.second], b);
    const double f = first.points[gap.first].value.si();
    before += own * own;
    after += left * left;
    size += f * f;
  }
  return size > 0.0 ? Cancelled{std::sqrt(before / size), std::sqrt(after / size)} : Cancelled{};
}

std::vector<std::string> cancel_notes(const MeasuredScan& first, const MeasuredScan& second, const ScanComparison& c) {
  std::vector<std::string> notes;
  for (std::size_t a = 0; a < first.components.size(); ++a) {
    const std::string& source = first.components[a].source;
    const auto other = std::ranges::find(second.components, source, &reflectance::ScanComponent::source);
    if (source.empty() || other == second.components.end()) continue;
    const auto b = static_cast<std::size_t>(other - second.components.begin());
    const Cancelled part = cancelled(first, a, second, b, c);
    if (part.before == 0.0) continue;
    notes.push_back(fmt::format("both share \"{}\": {:.2g} % of the values, {:.2g} % of the differences' scale is left",
                                first.components[a].name, kPercent * part.before, kPercent * part.after));
  }
  if (notes.empty()) notes.emplace_back("the scans share no source of error: nothing cancels");
  return notes;
}

// Where the table itself is what was measured: without its doubt between readings.
std::vector<AnalysisFact> facts_of_exact_table(const ScanComparison& c) {
  const std::string note = "the table between the file's readings taken for exact";
  return {{.name = "chi-square, exact table",
           .value = c.chi2,
           .unit = "1",
           .note = fmt::format("{}; {} degrees of freedom, p {:.3g}", note, c.degrees_of_freedom, c.p_value)},
          {.name = "share within U, exact table", .value = share_within_u(c), .unit = "%", .note = note}};
}

std::string interpolation_note(const ScanComparison& c) {
  std::vector<double> parts;
  for (const PointGap& gap : c.gaps) parts.push_back(gap.u_interpolation / gap.u);
  const auto middle = parts.begin() + static_cast<std::ptrdiff_t>(parts.size() / 2);
  std::ranges::nth_element(parts, middle);
  return fmt::format(
      "read between the file's readings as a table; what that may miss counts in u, as far as each reading is from its "
      "neighbours: {:.2g} % of u in the median",
      kPercent * *middle);
}

std::string outside_note(const ScanComparison& c, const reflectance::TableOptions& options) {
  return fmt::format(
      "not compared: {} points beyond the file's incidences or between two farther apart than {:.3g} deg, {} beyond "
      "its views, {} in cells wider than {:.3g} deg",
      c.outside.beyond_incidences, in_degrees(options.widest_incidence_step), c.outside.beyond_views,
      c.outside.in_holes, in_degrees(options.widest_cell));
}

}  // namespace

Result<Told> scans_compared(const MeasuredScan& first, const MeasuredScan& second, const std::string& stem) {
  const auto compared = reflectance::compare_scans(first, second);
  if (!compared) return failure(compared.error());
  Told told = told_of(first, *compared, second.name, stem);
  told.notes = cancel_notes(first, second, *compared);
  return told;
}

Result<Told> surface_compared(const MeasuredScan& scan, const ComparedSurface& other, const std::string& stem) {
  auto compared = reflectance::compare_with_surface(scan, other.surface);
  if (!compared) return failure(compared.error());
  compared->degrees_of_freedom -= std::min(other.spent, compared->degrees_of_freedom);
  compared->p_value =
      compared->degrees_of_freedom == 0
          ? 1.0
          : reflectance::chi_square_probability(compared->chi2, static_cast<double>(compared->degrees_of_freedom));
  Told told = told_of(scan, *compared, other.name, stem);
  told.notes.push_back(other.spent == 0
                           ? "the model is taken for exact: nothing cancels"
                           : fmt::format("fitted to this scan: {} ({} numbers spent)", other.name, other.spent));
  return told;
}

Result<Told> table_compared(const MeasuredScan& scan, const ComparedTable& other, const std::string& stem) {
  using reflectance::BetweenReadings;
  const auto compared = reflectance::compare_with_table(scan, other.table, other.readings, BetweenReadings::Uncertain);
  if (!compared) return failure(compared.error());
  const auto as_exact = reflectance::compare_with_table(scan, other.table, other.readings, BetweenReadings::Exact);
  if (!as_exact) return failure(as_exact.error());
  Told told = told_of(scan, *compared, other.name, stem);
  std::ranges::move(facts_of_exact_table(*as_exact), std::back_inserter(told.facts));
  const bool has_u = std::ranges::any_of(other.readings.points, [](const reflectance::MeasuredPoint& p) {
    return !p.is_flagged && standard_u(p) > Brdf{};
  });
  told.notes.emplace_back(has_u ? "the file's own uncertainties count, with the weights of its readings"
                                : "the file has no uncertainties: its readings are taken for exact");
  told.notes.push_back(interpolation_note(*compared));
  if (compared->unpaired_first > 0) told.notes.push_back(outside_note(*compared, other.table.options()));
  return told;
}

}  // namespace gonio::analysis
