// The report's sections on whether the scan agrees with itself, and with a model.
#include <map>

#include <fmt/format.h>

#include "daemon/analysis/html.h"
#include "daemon/analysis/report.h"

namespace gonio::analysis {
namespace {

using Rows = std::vector<std::vector<std::string>>;

std::vector<std::string> check_row(const ReportParts& parts, const api::ScanCheckReport& check) {
  std::string points;
  for (const std::int64_t point : check.worst_points) points += trace_command(parts.scan, point) + " ";
  const bool has_sum = check.degrees_of_freedom > 0.0;
  const bool is_decided = check.compared > 0;
  return {html_text(check.name),
          html_text(check.verdict),
          std::to_string(check.compared),
          has_sum ? fmt::format("{:.4g}", check.chi_square) : "",
          has_sum ? fmt::format("{:.6g}", check.degrees_of_freedom) : "",
          is_decided ? fmt::format("{:.3g}", check.worst_z) : "",
          is_decided ? fmt::format("{:.2g}", check.p_value) : "",
          html_text(check.finding) + (points.empty() ? "" : " " + points)};
}

std::string flags_text(const ReportParts& parts) {
  std::map<std::string, std::size_t> flags;
  for (const daemon::BrdfRow& row : parts.scan.brdf.rows) {
    for (std::size_t bit = 0; bit < parts.brdf.flag_names.size(); ++bit) {
      if ((row.flags >> bit & 1U) != 0) ++flags[parts.brdf.flag_names[bit]];
    }
  }
  std::string text;
  for (const auto& [name, count] : flags) text += fmt::format("{}{}: {} values", text.empty() ? "" : "; ", name, count);
  return text.empty() ? "none" : html_text(text);
}

}  // namespace

std::string checks_section(const ReportParts& parts) {
  Rows rows;
  for (const api::ScanCheckReport& check : parts.checks.checks) rows.push_back(check_row(parts, check));
  const daemon::ScanCounts& n = parts.scan.info.counts;
  std::vector<std::pair<std::string, std::string>> facts{
      {"flags", flags_text(parts)},
      {"attempts",
       fmt::format("{} for {} items; {} points measured again after a drift", n.attempts, n.items, n.reopened)},
      {"visits", fmt::format("{}: {} of the standard, {} of the sample, the rest of the dark", n.visits,
                             n.reference_visits, n.check_visits)},
      {"largest drift between visits", n.reference_visits + n.check_visits > 1
                                           ? fmt::format("{:.3g} %", 100.0 * parts.scan.info.largest_drift)
                                           : "not looked for"}};
  for (const api::AnalysisFact& fact : parts.facts) {
    if (!fact.name.starts_with("cross-validated")) continue;
    facts.emplace_back(html_text(fact.name), fact_value(fact) + " (" + html_text(fact.note) + ")");
  }
  return "<h2>Self-checks</h2>\n<p>" + html_text(parts.checks.summary) +
         fmt::format("; a check of a good scan fails with a probability of {:.1g}.</p>\n", parts.checks.false_alarm) +
         html_table({"check", "verdict", "compared", "chi-square", "dof", "worst z", "p", "finding"}, rows) +
         html_facts(facts) +
         fmt::format(
             "<p><code>gonioctl data check {0} -o json</code>, <code>gonioctl scan show {0} -o json</code>, "
             "<code>gonioctl data describe {0}</code>; pair by pair: <code>gonioctl data symmetry {0}</code>; "
             "values with flags: <code>gonioctl data export {0}</code></p>\n",
             parts.scan.info.id);
}

std::string fit_section(const ReportParts& parts) {
  std::string html =
      "<h2>Fit</h2>\n<p>The best of the usual models, weighted by the scan's covariance. What it leaves is "
      "drawn below.</p>\n";
  if (parts.fit.empty()) html += "<p>None.</p>\n";
  std::vector<std::pair<std::string, std::string>> facts;
  for (const api::AnalysisFact& fact : parts.fit) {
    facts.emplace_back(html_text(fact.name),
                       fact_value(fact) + (fact.note.empty() ? "" : " (" + html_text(fact.note) + ")"));
  }
  html += html_facts(facts);
  for (const std::string& note : parts.fit_notes) html += "<p>" + html_text(note) + "</p>\n";
  return html + fmt::format(
                    "<p><code>gonioctl data fit {0}</code>; the values it was made of: <code>gonioctl data "
                    "export {0}</code></p>\n",
                    parts.scan.info.id);
}

}  // namespace gonio::analysis
