// The report's sections on what came out: summary, budget, checks, values, gaps.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "calibration/calibrated_scan.h"
#include "daemon/analysis/html.h"
#include "daemon/analysis/report.h"
#include "daemon/results/calibration_desk.h"
#include "daemon/results/results.h"

namespace gonio::analysis {
namespace {

using daemon::BrdfRow;
using daemon::PointInfo;
using formats::BrdfPoint;
using Rows = std::vector<std::vector<std::string>>;

constexpr std::size_t kGapsShown = 60;
constexpr std::size_t kWorstShown = 20;

std::string percent(double fraction) {
  return fmt::format("{:.3g} %", 100.0 * fraction);
}

// Why a point has no value.
std::string gap_reason(const PointInfo& info, api::ReferenceMode mode) {
  if (info.point.blocked) return "in the detector's shadow";
  if (info.sample_outcome == "skipped") return "sample skipped";
  if (info.reference_outcome == "skipped") return "standard skipped";
  if (info.sample_outcome.empty()) return "sample not measured";
  if (info.reference_outcome.empty() && mode == api::ReferenceMode::SameGeometry) return "standard not measured";
  return "refused by the calibration";
}

std::string geometry_cell(const Geometry& g) {
  return fmt::format("{:.5g}, {:.5g}; {:.5g}, {:.5g}", in_degrees(g.theta_i), in_degrees(g.phi_i),
                     in_degrees(g.theta_r), in_degrees(g.phi_r));
}

double relative_u(const BrdfRow& row) {
  return daemon::budget_of(row).expanded_per_sr / std::abs(row.value_per_sr);
}

// Those told from zero, the most uncertain first.
std::vector<const BrdfRow*> by_uncertainty(const daemon::BrdfInfo& brdf) {
  std::vector<const BrdfRow*> rows;
  for (const BrdfRow& row : brdf.rows) {
    if (!calibration::has(row.flags, calibration::PointFlag::NearZero) && row.value_per_sr != 0.0) rows.push_back(&row);
  }
  std::ranges::sort(rows, std::ranges::greater(), [](const BrdfRow* row) { return relative_u(*row); });
  return rows;
}

std::vector<std::string> value_row(const ReportParts& parts, const BrdfRow& row, const std::string& why) {
  const daemon::StoredBudget budget = daemon::budget_of(row);
  std::string flags;
  for (std::size_t bit = 0; bit < parts.brdf.flag_names.size(); ++bit) {
    if ((row.flags >> bit & 1U) != 0) flags += (flags.empty() ? "" : ", ") + parts.brdf.flag_names[bit];
  }
  return {why,
          trace_command(parts.scan, row.point),
          geometry_cell(row.reported),
          fmt::format("{:.6g}", row.value_per_sr),
          fmt::format("{:.2g}", budget.expanded_per_sr),
          fmt::format("{:.3g}", budget.k),
          flags};
}

}  // namespace

std::string trace_command(const StoredScan& scan, std::int64_t point) {
  return fmt::format("<code>gonioctl data trace {} {}</code>", scan.info.id, point);
}

std::string fact_value(const api::AnalysisFact& fact) {
  std::string text = fmt::format("{:.6g}", fact.value);
  if (fact.expanded_u) text += fmt::format(" ± {:.2g}", *fact.expanded_u);
  return fact.unit == "1" ? text : text + " " + html_text(fact.unit);
}

std::string summary_section(const ReportParts& parts) {
  const daemon::ScanInfo& info = parts.scan.info;
  const daemon::RelativeUncertainty u = daemon::relative_uncertainty(parts.scan.brdf);
  std::vector<std::pair<std::string, std::string>> facts{
      {"points", fmt::format("{} planned, {} with a value, {} in the detector's shadow", info.counts.points,
                             parts.scan.brdf.rows.size(), info.counts.blocked)},
      {"U / |f<sub>r</sub>|",
       u.median ? "median " + percent(*u.median) + ", worst " + percent(*u.worst) + " (95.45 %, points told from zero)"
                : std::string("no value is told from zero")}};
  for (const api::AnalysisFact& fact : parts.facts) {
    if (fact.name.starts_with("cross-validated") || fact.name.find("points") != std::string::npos ||
        fact.name.starts_with("incidences") || fact.name == "channels") {
      continue;
    }
    facts.emplace_back(html_text(fact.name), fact_value(fact) + " (" + html_text(fact.note) + ")");
  }
  return "<h2>Result</h2>\n" + html_facts(facts) +
         fmt::format(
             "<p>Counts: <code>gonioctl scan show {0} -o json</code>. All values: <code>gonioctl data export "
             "{0}</code>. "
             "Integrals: <code>gonioctl data quantities {0}</code>, <code>gonioctl data describe {0}</code>. Each "
             "value down to its raw readings: "
             "<code>gonioctl data trace {0} POINT</code>.</p>\n",
             info.id);
}

std::string budget_section(const ReportParts& parts) {
  if (parts.budget.empty()) return "<h2>Budget</h2>\n<p>No value is told from zero.</p>\n";
  Rows rows;
  for (const BudgetLine& line : parts.budget) {
    rows.push_back({html_text(line.name), percent(line.median), percent(line.worst)});
  }
  const BrdfRow& worst = *by_uncertainty(parts.scan.brdf).front();
  return "<h2>Budget</h2>\n<p>Standard uncertainty (k = 1) of each component over |f<sub>r</sub>|, over the points "
         "told "
         "from zero. Components that all points share are correlated between them.</p>\n" +
         html_table({"component", "median", "worst"}, rows, 1) +
         fmt::format("<p><code>gonioctl data describe {}</code>; of the most uncertain point: ", parts.scan.info.id) +
         trace_command(parts.scan, worst.point) + "</p>\n";
}

std::string values_section(const ReportParts& parts) {
  std::vector<const BrdfRow*> rows;
  for (const BrdfRow& row : parts.scan.brdf.rows) rows.push_back(&row);
  const auto [least, most] =
      std::ranges::minmax_element(rows, {}, [](const BrdfRow* row) { return row->value_per_sr; });
  Rows cells{value_row(parts, **most, "largest"), value_row(parts, **least, "least")};
  const std::vector<const BrdfRow*> uncertain = by_uncertainty(parts.scan.brdf);
  for (std::size_t k = 0; k < std::min(kWorstShown, uncertain.size()); ++k) {
    cells.push_back(value_row(parts, *uncertain[k], k == 0 ? "most uncertain" : ""));
  }
  return "<h2>Values to look at</h2>\n<p>θ<sub>i</sub>, φ<sub>i</sub>; θ<sub>r</sub>, φ<sub>r</sub> in degrees, as the "
         "encoders say; f<sub>r</sub> and U in sr⁻¹.</p>\n" +
         html_table({"", "traced by", "directions", "f<sub>r</sub>", "U", "k", "flags"}, cells, 3);
}

std::string gaps_section(const ReportParts& parts) {
  std::vector<const PointInfo*> gaps;
  for (const PointInfo& info : parts.scan.points) {
    const auto row = std::ranges::find(parts.scan.brdf.rows, info.point.index, &BrdfRow::point);
    if (row == parts.scan.brdf.rows.end()) gaps.push_back(&info);
  }
  if (gaps.empty()) return "<h2>Gaps</h2>\n<p>None: every planned point has a value.</p>\n";
  Rows rows;
  for (std::size_t k = 0; k < std::min(kGapsShown, gaps.size()); ++k) {
    rows.push_back({trace_command(parts.scan, gaps[k]->point.index), geometry_cell(gaps[k]->point.geometry),
                    gap_reason(*gaps[k], parts.scan.info.policy.reference_mode), std::to_string(gaps[k]->attempts)});
  }
  std::string html = fmt::format("<h2>Gaps</h2>\n<p>{} of {} points have no value; none is filled in.</p>\n",
                                 gaps.size(), parts.scan.points.size());
  html += html_table({"traced by", "directions", "why", "attempts"}, rows, 3);
  if (gaps.size() > kGapsShown) html += fmt::format("<p>The first {} of them.</p>\n", kGapsShown);
  return html;
}

}  // namespace gonio::analysis
