#include "daemon/analysis/trace.h"

#include <algorithm>

#include <fmt/format.h>

#include "calibration/reference_standard.h"
#include "daemon/results/calibration_desk.h"

namespace gonio::analysis {
namespace {

using daemon::BrdfRow;

std::string geometry_text(const Geometry& g) {
  return fmt::format("theta_i {:.6g}, phi_i {:.6g}, theta_r {:.6g}, phi_r {:.6g} deg", in_degrees(g.theta_i),
                     in_degrees(g.phi_i), in_degrees(g.theta_r), in_degrees(g.phi_r));
}

std::string budget_lines(const BrdfRow& row, const std::vector<std::string>& names) {
  std::string text = fmt::format("    random                                    {:.4g} sr^-1\n", row.u_random_per_sr);
  for (std::size_t i = 0; i + 1 < row.sensitivities_per_sr.size(); i += 2) {
    const auto component = static_cast<std::size_t>(row.sensitivities_per_sr[i]);
    text += fmt::format("    {:<40}  {:.4g} sr^-1\n", component < names.size() ? names[component] : "?",
                        row.sensitivities_per_sr[i + 1]);
  }
  return text;
}

std::string recomputed_line(const BrdfRow& row, const daemon::NewBrdf& recomputed) {
  const auto again = std::ranges::find(recomputed.rows, row.point, &BrdfRow::point);
  if (again == recomputed.rows.end()) return "  computed anew from these readings: no value\n";
  const bool same = again->value_per_sr == row.value_per_sr && again->u_random_per_sr == row.u_random_per_sr &&
                    again->sensitivities_per_sr == row.sensitivities_per_sr;
  return fmt::format("  computed anew from these readings: {:.17g} sr^-1, {}\n", again->value_per_sr,
                     same ? "the same bits, U too" : "not the same");
}

// What the certificate says at the point's wavelength, between its entries as the calibration takes it.
std::string certificate_line(const StoredScan& scan, Wavelength wavelength) {
  const auto standard = calibration::ReferenceStandard::parse(scan.texts.reference, "the scan's reference");
  if (!standard) return "";
  const auto rho = standard->reflectance(wavelength);
  if (!rho) return "";
  return fmt::format("  standard {}, certified reflectance at {:.6g} nm: {:.8g}, U {:.4g} (k = 2)\n",
                     standard->serial(), in_nanometres(wavelength), rho->value, 2.0 * rho->u);
}

std::string value_lines(const StoredScan& scan, const BrdfRow& row, const daemon::NewBrdf& recomputed) {
  const daemon::StoredBudget budget = daemon::budget_of(row);
  std::string text = fmt::format("value  {:.17g} sr^-1, u {:.4g}, k {:.4g}, U {:.4g} sr^-1\n", row.value_per_sr,
                                 budget.u_per_sr, budget.k, budget.expanded_per_sr);
  text += fmt::format("  at {}, as the encoders say\n", geometry_text(row.reported));
  text += fmt::format("  calibration {} ({}), of {}\n", scan.brdf.calibration, scan.brdf.code_version,
                      scan.brdf.inputs_json);
  text += recomputed_line(row, recomputed);
  text += "  budget, one standard deviation of each:\n" + budget_lines(row, scan.brdf.component_names);
  return text;
}

std::string reading_line(const daemon::TracedReading& r) {
  std::string text = fmt::format("    reading {} at {}: ", r.reading, r.utc);
  if (r.power_w) {
    text += fmt::format("{:.17g} W", *r.power_w);
  } else {
    text += fmt::format(
        "mean {:.17g} DN, m2 {:.9g} DN^2, m3 {:.6g} DN^3, m4 {:.6g} DN^4 of {} pixels, {} saturated, "
        "{:.9g} s, {:.3g} dB",
        r.mean_dn, r.m2_dn2, r.m3_dn3, r.m4_dn4, r.pixels, r.saturated, r.exposure_s, r.gain_db);
  }
  text += fmt::format(", monitor {:.9g} +- {:.2g}", r.monitor_mean, r.monitor_se);
  return text + (r.used ? "\n" : ", not used\n");
}

// A dark is subtracted from readings of its own exposure.
bool is_exposed_alike(const daemon::PointTrace& trace, const daemon::TracedReading& dark) {
  return std::ranges::any_of(trace.attempts, [&](const daemon::TracedAttempt& attempt) {
    return std::ranges::any_of(attempt.readings, [&](const daemon::TracedReading& lit) {
      return lit.exposure_s == dark.exposure_s && lit.gain_db == dark.gain_db;
    });
  });
}

std::string attempt_lines(const daemon::TracedAttempt& a) {
  std::string text = fmt::format("{} attempt {} (try {}, {}): {}", a.target, a.attempt, a.number, a.utc, a.outcome);
  if (a.in_force) text += ", in force";
  if (a.round > 1) text += fmt::format(", round {}", a.round);
  if (!a.error.empty()) text += ", " + a.error;
  text += '\n';
  for (const daemon::TracedReading& reading : a.readings) text += reading_line(reading);
  return text;
}

}  // namespace

Result<std::string> trace_text(const StoredScan& scan, const daemon::PointTrace& trace, std::int32_t point,
                               const daemon::NewBrdf& recomputed) {
  const auto planned =
      std::ranges::find(scan.points, point, [](const daemon::PointInfo& info) { return info.point.index; });
  if (planned == scan.points.end()) {
    return failure({.code = ErrorCode::NotFound,
                    .device = "analysis",
                    .tried = fmt::format("trace point {} of scan {}", point, scan.info.id),
                    .seen = "the scan has no such point",
                    .limit = fmt::format("0 to {}", std::ssize(scan.points) - 1)});
  }
  std::string text = fmt::format("scan {} \"{}\", sample \"{}\", point {}: {}, {:.6g} nm\n", scan.info.id,
                                 scan.info.name, scan.info.sample, point, geometry_text(planned->point.geometry),
                                 in_nanometres(planned->point.wavelength));
  const auto row = std::ranges::find(scan.brdf.rows, point, &BrdfRow::point);
  text += row == scan.brdf.rows.end()
              ? std::string(planned->point.blocked ? "no value: in the detector's shadow\n" : "no value\n")
              : value_lines(scan, *row, recomputed);
  text += certificate_line(scan, planned->point.wavelength);
  for (const daemon::TracedAttempt& attempt : trace.attempts) text += attempt_lines(attempt);
  if (planned->reference_outcome.empty() && !planned->point.blocked) {
    text +=
        "the standard was not read for this point: a value without it rests on the same geometry's reading, on the "
        "visits of the anchor, or on none, by the plan's mode\n";
  }
  for (const daemon::TracedVisit& dark : trace.darks) {
    // A budget counts visits and attempts as one list (StoreReader::readings).
    text += fmt::format("{} visit {} ({}), beside these attempts; in the budget: visit {}\n", dark.kind, dark.visit,
                        dark.utc, 2 * dark.visit + 1);
    for (const daemon::TracedReading& reading : dark.readings) {
      if (is_exposed_alike(trace, reading)) text += reading_line(reading);
    }
  }
  return text;
}

}  // namespace gonio::analysis
