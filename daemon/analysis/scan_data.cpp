#include "daemon/analysis/scan_data.h"

#include <fmt/format.h>

#include "daemon/results/calibration_desk.h"

namespace gonio::analysis {
namespace {

using reflectance::MeasuredPoint;
using reflectance::MeasuredScan;
using reflectance::ScanComponent;

// What error a component is, for other scans; empty: this scan's own.
std::string source_of(const std::string& name, const StoredScan& scan) {
  if (daemon::is_drawn_anew(name)) return {};
  const bool is_standards = name.starts_with("certificate") || name.starts_with("shape");
  const std::string bare = name.substr(0, name.find(" ["));
  return bare + (is_standards ? " of " + scan.texts.reference_sha256 : " of " + scan.texts.instrument_sha256);
}

MeasuredPoint data_point(const daemon::BrdfRow& row) {
  MeasuredPoint point{.geometry = row.reported,
                      .value = per_steradian(row.value_per_sr),
                      .u_random = per_steradian(row.u_random_per_sr)};
  for (std::size_t i = 0; i + 1 < row.sensitivities_per_sr.size(); i += 2) {
    point.shared.push_back({.component = static_cast<std::uint32_t>(row.sensitivities_per_sr[i]),
                            .per_sd = per_steradian(row.sensitivities_per_sr[i + 1])});
  }
  return point;
}

}  // namespace

Result<MeasuredScan> scan_data(const StoredScan& scan, const formats::MeasuredBrdf& brdf, std::size_t channel) {
  if (channel >= brdf.channels.size()) {
    return failure({.code = ErrorCode::InvalidInput,
                    .device = "analysis",
                    .tried = "take a channel",
                    .seen = fmt::format("number {}", channel),
                    .limit = fmt::format("{} channels", brdf.channels.size())});
  }
  MeasuredScan data{.name = fmt::format("scan {}", scan.info.id),
                    .symmetry = *brdf.metadata.symmetry,
                    .components = {},
                    .points = {}};
  for (const std::string& name : scan.brdf.component_names) {
    data.components.push_back({.name = name.substr(0, name.find(" [")), .source = source_of(name, scan)});
  }
  for (const std::uint32_t place : scan.brdf.sizes_only) {
    if (place < data.components.size()) data.components[place].is_pattern_known = false;
  }
  // `brdf` was made of these rows, in their order.
  for (std::size_t n = 0; n < scan.brdf.rows.size(); ++n) {
    if (brdf.points[n].channel == channel) data.points.push_back(data_point(scan.brdf.rows[n]));
  }
  return data;
}

}  // namespace gonio::analysis
