// The report's sections on where it comes from: sample, calibration chain, environment, people, hashes.
#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "calibration/reference_standard.h"
#include "daemon/analysis/environment.h"
#include "daemon/analysis/html.h"
#include "daemon/analysis/report.h"
#include "daemon/config/instrument.h"
#include "daemon/store/event_facts.h"

namespace gonio::analysis {
namespace {

using Facts = std::vector<std::pair<std::string, std::string>>;

constexpr std::size_t kStepsShown = 80;

std::string list_text(const std::set<double>& values, const char* unit) {
  constexpr std::size_t kMost = 24;
  std::string text;
  std::size_t n = 0;
  for (const double value : values) {
    if (n++ == kMost) return text + fmt::format(", ... ({} in all) {}", values.size(), unit);
    text += (text.empty() ? "" : ", ") + fmt::format("{:.5g}", value);
  }
  return text + " " + unit;
}

std::string code(const std::string& text) {
  return "<code class=\"hash\">" + html_text(text) + "</code>";
}

void add_certificate(Facts& facts, const ReportParts& parts) {
  const auto standard = calibration::ReferenceStandard::parse(parts.scan.texts.reference, "the scan's reference");
  if (!standard) {
    facts.emplace_back("certificate", html_text(describe(standard.error())));
    return;
  }
  const calibration::Certificate& certificate = standard->certificate();
  facts.emplace_back("standard", html_text(standard->serial() + ", " + standard->material()));
  facts.emplace_back("certificate",
                     html_text(fmt::format("of {}, holds to {}; stated with k = {:.3g}", certificate.date,
                                           certificate.expires, certificate.coverage_factor)));
  for (const formats::Channel& channel : parts.brdf.channels) {
    const auto rho = standard->reflectance(nanometres(channel.wavelength_nm));
    if (!rho) continue;
    facts.emplace_back(fmt::format("certified reflectance at {:.6g} nm", channel.wavelength_nm),
                       fmt::format("{:.5g} ± {:.2g} (k = 2)", rho->value, 2.0 * rho->u));
  }
}

// At each wavelength the first point that has a value.
std::string certificate_traces(const ReportParts& parts) {
  std::set<std::int32_t> valued;
  for (const daemon::BrdfRow& row : parts.scan.brdf.rows) valued.insert(row.point);
  std::set<double> wavelengths;
  std::string html;
  for (const daemon::PointInfo& info : parts.scan.points) {
    const bool is_first =
        valued.contains(info.point.index) && wavelengths.insert(in_nanometres(info.point.wavelength)).second;
    if (is_first) html += ", " + trace_command(parts.scan, info.point.index);
  }
  return html;
}

}  // namespace

std::string sample_section(const ReportParts& parts) {
  const daemon::ScanInfo& info = parts.scan.info;
  std::set<double> theta_i;
  std::set<double> phi_i;
  std::set<double> theta_r;
  std::set<double> phi_r;
  std::set<double> wavelengths;
  for (const daemon::PointInfo& point : parts.scan.points) {
    theta_i.insert(in_degrees(point.point.geometry.theta_i));
    phi_i.insert(in_degrees(point.point.geometry.phi_i));
    theta_r.insert(in_degrees(point.point.geometry.theta_r));
    phi_r.insert(in_degrees(point.point.geometry.phi_r));
    wavelengths.insert(in_nanometres(point.point.wavelength));
  }
  Facts facts{{"sample", html_text(info.sample)},
              {"campaign", info.campaign.empty() ? "none" : html_text(info.campaign)},
              {"isotropic", info.isotropic ? "declared so: only φ<sub>r</sub> - φ<sub>i</sub> counts" : "no"},
              {"θ<sub>i</sub>", list_text(theta_i, "°")},
              {"φ<sub>i</sub>", list_text(phi_i, "°")},
              {"θ<sub>r</sub>", list_text(theta_r, "°")},
              {"φ<sub>r</sub>", list_text(phi_r, "°")},
              {"wavelength", list_text(wavelengths, "nm")}};
  return "<h2>Sample and geometry</h2>\n<p>Directions point away from the surface: i to the source, r to the detector; "
         "θ "
         "from the normal, φ counter-clockwise seen from above. Retro-reflection: θ<sub>r</sub> = θ<sub>i</sub>, "
         "φ<sub>r</sub> = φ<sub>i</sub>.</p>\n" +
         html_facts(facts) + "<pre>" + html_text(parts.scan.texts.plan) + "</pre>\n" +
         fmt::format(
             "<p>The plan again: <code>gonioctl scan show {0} -o json</code>; its points: <code>gonioctl data "
             "export {0}</code></p>\n",
             info.id);
}

std::string chain_section(const ReportParts& parts) {
  Facts facts;
  add_certificate(facts, parts);
  if (const auto instrument = daemon::parse_instrument(parts.scan.texts.instrument, "instrument.toml")) {
    facts.emplace_back("instrument", html_text(instrument->name));
    facts.emplace_back("half cones",
                       fmt::format("detector {:.3g}°, source {:.3g}°", in_degrees(instrument->cones.detector_half),
                                   in_degrees(instrument->cones.source_half)));
  }
  facts.emplace_back("calibration", fmt::format("version {} ({})", parts.scan.brdf.calibration,
                                                html_text(parts.scan.brdf.code_version)));
  facts.emplace_back("its inputs", code(parts.scan.brdf.inputs_json));
  facts.emplace_back("measurand",
                     "f<sub>r</sub> at the reported directions and the wavelength's centroid, at zero aperture");
  return "<h2>Calibration chain</h2>\n" + html_facts(facts) +
         fmt::format("<p><code>gonioctl reference show {}</code>, <code>gonioctl instrument</code>",
                     html_text(parts.scan.info.reference_serial)) +
         certificate_traces(parts) + "</p>\n";
}

std::string environment_section(const ReportParts& parts) {
  if (parts.history.readings.empty()) return "<h2>Environment</h2>\n<p>No reading.</p>\n";
  Facts facts;
  for (const api::AnalysisFact& fact : environment_facts(parts.history.readings)) {
    facts.emplace_back(html_text(fact.name),
                       fact_value(fact) + (fact.note.empty() ? "" : " (" + html_text(fact.note) + ")"));
  }
  facts.emplace_back("first and last",
                     iso8601(parts.history.readings.front().at) + " to " + iso8601(parts.history.readings.back().at));
  return "<h2>Environment</h2>\n" + html_facts(facts) +
         fmt::format("<p>Every raw reading: <code>gonioctl data readings {}</code></p>\n", parts.scan.info.id);
}

std::string people_section(const ReportParts& parts) {
  // Visits come by the hundred, and the picture of the course has them.
  std::vector<daemon::HistoryStep> steps = parts.history.steps;
  const auto visits =
      std::erase_if(steps, [](const daemon::HistoryStep& step) { return step.kind.ends_with("-visit"); });
  std::vector<std::vector<std::string>> rows;
  for (const daemon::HistoryStep& step : steps) {
    if (rows.size() == kStepsShown) break;
    rows.push_back(
        {iso8601(step.at), html_text(step.kind), html_text(step.who), html_text(daemon::event_facts(step.json))});
  }
  const daemon::ScanInfo& info = parts.scan.info;
  std::string html =
      "<h2>Who and when</h2>\n" +
      html_facts({{"submitted", iso8601(info.submitted) + " by " + html_text(info.who)},
                  {"last change", iso8601(info.changed) + ": " + std::string(daemon::scan_state_name(info.state)) +
                                      (info.outcome.empty() ? "" : ", " + html_text(info.outcome))}});
  if (!rows.empty()) html += html_table({"when", "what", "who", ""}, rows);
  if (steps.size() > kStepsShown) html += fmt::format("<p>The first {} of {} steps.</p>\n", kStepsShown, steps.size());
  if (visits > 0) html += fmt::format("<p>And {} visits: see the course of the scan among the pictures.</p>\n", visits);
  return html + "<p>All: <code>gonioctl events</code></p>\n";
}

std::string origins_section(const ReportParts& parts) {
  const daemon::ScanTexts& texts = parts.scan.texts;
  return "<h2>Software and configuration</h2>\n" +
         html_facts({{"report by", "goniod " GONIO_VERSION},
                     {"calibration code", html_text(parts.scan.brdf.code_version)},
                     {"plan", html_text(texts.plan_file) + ", sha256 " + code(texts.plan_sha256)},
                     {"instrument", "sha256 " + code(texts.instrument_sha256) + ", without addresses " +
                                        code(parts.scan.info.instrument_hash)},
                     {"standard's file", "sha256 " + code(texts.reference_sha256)}}) +
         fmt::format("<p>All of them: <code>gonioctl data export {}</code>, in its head</p>\n", parts.scan.info.id);
}

}  // namespace gonio::analysis
