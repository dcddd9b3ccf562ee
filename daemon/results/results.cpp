#include "daemon/results/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "calibration/calibrated_scan.h"
#include "calibration/point_flags.h"
#include "daemon/config/instrument.h"
#include "daemon/results/calibration_desk.h"
#include "daemon/store/policy_names.h"
#include "daemon/store/version_list.h"

namespace gonio::daemon {
namespace {

using calibration::PointFlag;

constexpr int kPointsAtOnce = 5000;
void set_geometry(api::BrdfReport& report, const Geometry& g) {
  report.theta_i_deg = in_degrees(g.theta_i);
  report.phi_i_deg = in_degrees(g.phi_i);
  report.theta_r_deg = in_degrees(g.theta_r);
  report.phi_r_deg = in_degrees(g.phi_r);
}

std::string status_without_value(const PointInfo& info, api::ReferenceMode mode) {
  if (info.point.blocked) return "blocked";
  if (info.sample_outcome == "skipped" || info.reference_outcome == "skipped") return "skipped";
  const bool needs_reference = mode == api::ReferenceMode::SameGeometry;
  const bool all = info.sample_outcome == "accepted" && (!needs_reference || info.reference_outcome == "accepted");
  return all ? "refused" : "unmeasured";
}

double own_u(const BrdfRow& row, const std::vector<std::string>& component_names) {
  double variance = row.u_random_per_sr * row.u_random_per_sr;
  for (std::size_t i = 0; i + 1 < row.sensitivities_per_sr.size(); i += 2) {
    const auto component = static_cast<std::size_t>(row.sensitivities_per_sr[i]);
    if (component < component_names.size() && is_drawn_anew(component_names[component])) {
      variance += row.sensitivities_per_sr[i + 1] * row.sensitivities_per_sr[i + 1];
    }
  }
  return std::sqrt(variance);
}

api::BrdfReport report_of(const PointInfo& info, const BrdfRow* row, const std::vector<std::string>& component_names,
                          api::ReferenceMode mode) {
  api::BrdfReport report;
  report.point = info.point.index;
  report.wavelength_nm = in_nanometres(info.point.wavelength);
  set_geometry(report, row == nullptr ? info.point.geometry : row->reported);
  if (row == nullptr) {
    report.status = status_without_value(info, mode);
    if (info.point.blocked) report.flags = calibration::flag_name(PointFlag::Blocked);
    return report;
  }
  const StoredBudget budget = budget_of(*row);
  report.brdf_per_sr = row->value_per_sr;
  report.u_random_per_sr = row->u_random_per_sr;
  report.u_shared_per_sr = budget.u_shared_per_sr;
  report.u_own_per_sr = own_u(*row, component_names);
  report.u_per_sr = budget.u_per_sr;
  report.k = budget.k;
  report.expanded_u_per_sr = budget.expanded_per_sr;
  report.below_per_sr = budget.below_per_sr;
  report.above_per_sr = budget.above_per_sr;
  report.status = "accepted";
  report.flags = calibration::flag_words(row->flags);
  return report;
}

Result<std::vector<PointInfo>> all_points(StoreReader& reader, ScanId scan) {
  std::vector<PointInfo> points;
  for (;;) {
    const std::int32_t after = points.empty() ? -1 : points.back().point.index;
    Result<std::vector<PointInfo>> page = reader.points(scan, after, kPointsAtOnce);
    if (!page) return failure(page.error());
    points.insert(points.end(), page->begin(), page->end());
    if (std::ssize(*page) < kPointsAtOnce) return points;
  }
}

std::vector<api::BrdfReport> join(const std::vector<PointInfo>& points, const BrdfInfo& brdf, api::ReferenceMode mode) {
  std::map<std::int32_t, const BrdfRow*> rows;
  for (const BrdfRow& row : brdf.rows) rows[row.point] = &row;
  std::vector<api::BrdfReport> reports;
  for (const PointInfo& point : points) {
    const auto row = rows.find(point.point.index);
    reports.push_back(report_of(point, row == rows.end() ? nullptr : row->second, brdf.component_names, mode));
  }
  return reports;
}

std::string cell(const std::optional<double>& value) {
  return value ? fmt::format("{:.9g}", *value) : std::string();
}

std::string csv_row(const api::BrdfReport& r) {
  return fmt::format("{},{:.6f},{:.6f},{:.6f},{:.6f},{:.6g},{},{},{},{},{},{},{},{},{},{}\n", r.point, r.theta_i_deg,
                     r.phi_i_deg, r.theta_r_deg, r.phi_r_deg, r.wavelength_nm, cell(r.brdf_per_sr),
                     cell(r.u_random_per_sr), cell(r.u_shared_per_sr), cell(r.u_per_sr), cell(r.k),
                     cell(r.expanded_u_per_sr), cell(r.below_per_sr), cell(r.above_per_sr), r.status, r.flags);
}

// Names may hold anything: a line of metadata is one line.
std::string one_line(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

std::string metadata(const ScanInfo& info, const ScanTexts& texts, const BrdfInfo& brdf, const std::string& software) {
  std::string text = "# gonioreflectometer scan: BRDF with uncertainty\n";
  const auto add = [&](std::string_view key, const std::string& value) {
    text += fmt::format("# {}: {}\n", key, one_line(value));
  };
  add("scan", fmt::format("{}, {}", info.id, info.name));
  add("sample", info.sample);
  add("state", std::string(scan_state_name(info.state)));
  add("submitted_utc", iso8601(info.submitted));
  add("finished_utc", is_over(info.state) ? iso8601(info.changed) : "not finished");
  add("plan", texts.plan_file);
  add("plan_sha256", texts.plan_sha256);
  add("instrument_sha256", info.instrument_hash);
  add("reference", info.reference_serial);
  add("reference_sha256", texts.reference_sha256);
  add("reference_mode", std::string(kReferenceModeNames[static_cast<std::size_t>(info.policy.reference_mode)]));
  add("calibration", brdf.code_version + ", " + brdf.inputs_json);
  add("calibration_versions",
      brdf.versions.empty() ? "none: by instrument.toml alone" : version_list_text(brdf.versions));
  add("software", software);
  if (const Result<Instrument> instrument = parse_instrument(texts.instrument, "instrument.toml")) {
    add("detector_half_cone_deg", fmt::format("{:.6g}", in_degrees(instrument->cones.detector_half)));
    add("source_half_cone_deg", fmt::format("{:.6g}", in_degrees(instrument->cones.source_half)));
  }
  add("isotropic", info.isotropic ? "true" : "false");
  add("directions",
      "i to the source, r to the detector, theta from the normal; as the encoders say where measured, else as planned");
  add("uncertainty",
      "u: standard (k = 1); expanded_u = k u for a level of confidence of 95.45 %, k by the degrees of freedom");
  return text;
}

}  // namespace

Result<std::vector<api::BrdfReport>> results_of(StoreReader& reader, ScanId scan) {
  const Result<ScanInfo> info = reader.scan(scan);
  if (!info) return failure(info.error());
  const Result<BrdfInfo> brdf = brdf_of(reader, scan);
  if (!brdf) return failure(brdf.error());
  const Result<std::vector<PointInfo>> points = all_points(reader, scan);
  if (!points) return failure(points.error());
  return join(*points, *brdf, info->policy.reference_mode);
}

Result<std::string> export_csv(StoreReader& reader, ScanId scan, const std::string& software) {
  const Result<ScanInfo> info = reader.scan(scan);
  if (!info) return failure(info.error());
  const Result<ScanTexts> texts = reader.texts(scan);
  if (!texts) return failure(texts.error());
  const Result<BrdfInfo> brdf = brdf_of(reader, scan);
  if (!brdf) return failure(brdf.error());
  const Result<std::vector<PointInfo>> points = all_points(reader, scan);
  if (!points) return failure(points.error());
  std::string text = metadata(*info, *texts, *brdf, software);
  text +=
      "point,theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,wavelength_nm,brdf_per_sr,u_random_per_sr,u_shared_per_sr,"
      "u_per_sr,k,expanded_u_per_sr,below_per_sr,above_per_sr,status,flags\n";
  for (const api::BrdfReport& report : join(*points, *brdf, info->policy.reference_mode)) text += csv_row(report);
  return text;
}

RelativeUncertainty relative_uncertainty(const BrdfInfo& brdf) {
  std::vector<double> relative;
  for (const BrdfRow& row : brdf.rows) {
    if (!has(row.flags, PointFlag::NearZero)) {
      relative.push_back(budget_of(row).expanded_per_sr / std::abs(row.value_per_sr));
    }
  }
  RelativeUncertainty found{.values = std::ssize(brdf.rows)};
  if (relative.empty()) return found;
  std::ranges::sort(relative);
  const std::size_t n = relative.size();
  found.median = 0.5 * (relative[(n - 1) / 2] + relative[n / 2]);
  found.worst = relative.back();
  return found;
}

}  // namespace gonio::daemon
