#include "cli/calibration_views.h"

#include <fmt/format.h>

#include <cmath>

namespace gonio::cli {
namespace {

// The value to the second digit of its uncertainty.
std::string with_u(const api::FoundValueReport& found) {
  const std::string unit = found.unit == "1" ? "" : " " + found.unit;
  if (!(found.u > 0.0)) return fmt::format("{:.6g}{}", found.value, unit);
  const int decimals = std::max(0, 1 - static_cast<int>(std::floor(std::log10(found.u))));
  constexpr int kMostDecimals = 12;
  const int shown = std::min(decimals, kMostDecimals);
  return fmt::format("{:.{}f} +- {:.{}f}{}", found.value, shown, found.u, shown, unit);
}

std::string all_values(const api::CalibrationReport& calibration) {
  std::string text;
  for (const api::FoundValueReport& found : calibration.values) {
    text += (text.empty() ? "" : "; ") + found.name + " " + with_u(found);
  }
  return text;
}

// Of each pair whose errors go together: "zero_theta_i_deg with zero_theta_r_deg +0.99".
std::string correlations(const api::CalibrationReport& calibration) {
  constexpr double kWorthSaying = 0.05;
  const std::size_t n = calibration.values.size();
  std::string text;
  if (calibration.covariance.size() != n * n) return text;
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n; ++b) {
      const double scale = calibration.values[a].u * calibration.values[b].u;
      const double r = scale > 0.0 ? calibration.covariance[a * n + b] / scale : 0.0;
      if (std::abs(r) < kWorthSaying) continue;
      text += fmt::format("{}{} with {} {:+.2f}", text.empty() ? "" : "; ", calibration.values[a].name,
                          calibration.values[b].name, r);
    }
  }
  return text;
}

std::string history(const api::CalibrationReport& calibration) {
  std::string text;
  for (const api::CalibrationUseReport& use : calibration.uses) {
    text += fmt::format("{}{} {} by {}{}", text.empty() ? "" : "; ", use.in_use ? "in use from" : "not in use from",
                        use.utc, use.who, use.reason.empty() ? "" : " (" + use.reason + ")");
  }
  return text;
}

}  // namespace

Table view(const api::CalibrationList& calibrations) {
  Table table{.header = {"version", "counts", "job", "scan", "sample", "found_utc", "values"}, .rows = {}};
  for (const api::CalibrationReport& one : calibrations.calibrations) {
    table.rows.push_back({std::to_string(one.version), one.counts ? "yes" : "no", one.job, std::to_string(one.scan),
                          one.sample, one.utc, all_values(one)});
  }
  return table;
}

Table view(const api::CalibrationReport& calibration) {
  Table table{.header = {}, .rows = {{}}};
  const auto add = [&table](std::string name, std::string value) {
    table.header.push_back(std::move(name));
    table.rows[0].push_back(std::move(value));
  };
  add("version", std::to_string(calibration.version));
  add("job", calibration.job);
  add("counts", calibration.counts ? "yes" : "no");
  for (const api::FoundValueReport& found : calibration.values) add(found.name, with_u(found));
  add("correlations", correlations(calibration));
  add("how_it_fitted", calibration.note);
  add("scan", std::to_string(calibration.scan));
  add("sample", calibration.sample);
  add("found_utc", calibration.utc);
  add("code", calibration.code_version);
  add("inputs", calibration.inputs);
  add("history", history(calibration));
  return table;
}

Table view(const api::ChartReport& chart) {
  Table table{.header = {"scan", "utc", "value", "u_own", "deviation_sd", "breaks"}, .rows = {}};
  for (const api::ChartPointReport& point : chart.points) {
    table.rows.push_back({std::to_string(point.scan), point.utc, fmt::format("{:.6f}", point.value),
                          fmt::format("{:.2g}", point.u),
                          chart.baseline > 0 ? fmt::format("{:+.2f}", point.deviation) : "", point.broken});
  }
  return table;
}

std::string chart_sentence(const api::ChartReport& chart) {
  if (chart.baseline == 0) return fmt::format("{}, {}: {}", chart.standard, chart.quantity, chart.verdict);
  return fmt::format("{}, {}: centre {:.6f}, limits {:.6f} to {:.6f} (3 sd, from the first {} runs); {}",
                     chart.standard, chart.quantity, chart.centre, chart.low, chart.high, chart.baseline,
                     chart.verdict);
}

}  // namespace gonio::cli
