#include "daemon/analysis/stored_scan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "calibration/calibrated_scan.h"
#include "daemon/config/instrument.h"
#include "daemon/results/calibration_desk.h"

namespace gonio::analysis {
namespace {

using daemon::BrdfRow;
using daemon::PointInfo;
using formats::BrdfPoint;
using formats::MeasuredBrdf;
using reflectance::TableSymmetry;

constexpr int kPointsAtOnce = 5000;
constexpr unsigned kMostFlags = 32;

Result<std::vector<PointInfo>> all_points_of(daemon::StoreReader& reader, daemon::ScanId scan) {
  std::vector<PointInfo> points;
  for (;;) {
    const std::int32_t after = points.empty() ? -1 : points.back().point.index;
    Result<std::vector<PointInfo>> page = reader.points(scan, after, kPointsAtOnce);
    if (!page) return failure(page.error());
    points.insert(points.end(), page->begin(), page->end());
    if (std::ssize(*page) < kPointsAtOnce) return points;
  }
}

// All flags that the calibration knows, in the order of their bits: bit n is name n.
std::vector<std::string> all_flag_names() {
  std::vector<std::string> names;
  for (unsigned bit = 0; bit < kMostFlags; ++bit) {
    const std::string_view name = calibration::flag_name(static_cast<calibration::PointFlag>(1U << bit));
    if (name.empty()) break;
    names.emplace_back(name);
  }
  return names;
}

double solid_angle(Angle half_cone) {
  return 2.0 * std::numbers::pi * (1.0 - std::cos(half_cone.si()));
}

// By the planned azimuths: encoders never say exactly 0 or 180 deg, and a half-space would look like two sides.
TableSymmetry planned_symmetry(const StoredScan& scan) {
  constexpr double kSame = 1e-6;
  if (!scan.info.isotropic) return TableSymmetry::Anisotropic;
  bool is_left = false;
  bool is_right = false;
  for (const PointInfo& info : scan.points) {
    const Geometry& g = info.point.geometry;
    const double aside = std::sin((g.phi_r - g.phi_i).si()) * std::sin(g.theta_i.si()) * std::sin(g.theta_r.si());
    is_left = is_left || aside > kSame;
    is_right = is_right || aside < -kSame;
  }
  return is_left && is_right ? TableSymmetry::Turn : TableSymmetry::Isotropic;
}

formats::BrdfMetadata metadata_of(const StoredScan& scan) {
  formats::BrdfMetadata m;
  m.id = fmt::format("urn:goniod:scan:{}:{:.16}", scan.info.id, scan.texts.plan_sha256);
  m.description = scan.info.name;
  m.measured_at = iso8601(scan.info.submitted);
  m.software = fmt::format("goniod {}, calibration {}", GONIO_VERSION, scan.brdf.code_version);
  m.sample = scan.info.sample;
  m.symmetry = planned_symmetry(scan);
  m.references = {scan.info.reference_serial};
  m.operator_name = scan.info.who;
  if (const auto instrument = daemon::parse_instrument(scan.texts.instrument, "instrument.toml")) {
    m.instrument = instrument->name;
    m.detector_solid_angle_sr = solid_angle(instrument->cones.detector_half);
  }
  m.remarks = {{"scan", std::to_string(scan.info.id)},
               {"campaign", scan.info.campaign},
               {"state", std::string(daemon::scan_state_name(scan.info.state))},
               {"plan_sha256", scan.texts.plan_sha256},
               {"instrument_sha256", scan.texts.instrument_sha256},
               {"reference_sha256", scan.texts.reference_sha256},
               {"calibration_version", std::to_string(scan.brdf.calibration)},
               {"calibration_inputs", scan.brdf.inputs_json}};
  return m;
}

BrdfPoint point_of(const BrdfRow& row, std::uint32_t channel, std::size_t flags) {
  const daemon::StoredBudget budget = daemon::budget_of(row);
  BrdfPoint point;
  point.theta_i_deg = in_degrees(row.reported.theta_i);
  point.phi_i_deg = in_degrees(row.reported.phi_i);
  point.theta_r_deg = in_degrees(row.reported.theta_r);
  point.phi_r_deg = in_degrees(row.reported.phi_r);
  point.f_per_sr = row.value_per_sr;
  point.U_per_sr = budget.expanded_per_sr;
  point.k = budget.k;
  point.u_shared_per_sr = budget.u_shared_per_sr;
  point.channel = channel;
  point.flags = flags < kMostFlags ? row.flags & ((1U << flags) - 1U) : row.flags;
  return point;
}

Error without_values(const StoredScan& scan) {
  const daemon::ScanCounts& n = scan.info.counts;
  return {.code = ErrorCode::InvalidInput,
          .device = "analysis",
          .tried = fmt::format("take the values of scan {}", scan.info.id),
          .seen = fmt::format("no value: {} points, {} items accepted, {} skipped, {} points blocked", n.points,
                              n.accepted, n.skipped, n.blocked),
          .limit = "a point whose sample and reference are accepted"};
}

// Flags that every value has.
std::string flags_of_all(const MeasuredBrdf& brdf) {
  std::uint32_t common = ~0U;
  for (const BrdfPoint& point : brdf.points) common &= point.flags;
  std::string names;
  for (std::size_t bit = 0; bit < brdf.flag_names.size(); ++bit) {
    if ((common >> bit & 1U) != 0) names += (names.empty() ? "" : ", ") + brdf.flag_names[bit];
  }
  return names;
}

std::size_t incidences_of(const StoredScan& scan) {
  std::set<std::pair<double, double>> found;
  for (const PointInfo& info : scan.points) {
    const Geometry& g = info.point.geometry;
    found.emplace(in_degrees(g.theta_i), scan.info.isotropic ? 0.0 : in_degrees(g.phi_i));
  }
  return found.size();
}

}  // namespace

Result<StoredScan> read_stored_scan(daemon::StoreReader& reader, daemon::ScanId scan) {
  Result<daemon::ScanInfo> info = reader.scan(scan);
  if (!info) return failure(info.error());
  Result<daemon::ScanTexts> texts = reader.texts(scan);
  if (!texts) return failure(texts.error());
  Result<daemon::BrdfInfo> brdf = daemon::brdf_of(reader, scan);
  if (!brdf) return failure(brdf.error());
  Result<std::vector<PointInfo>> points = all_points_of(reader, scan);
  if (!points) return failure(points.error());
  return StoredScan{
      .info = std::move(*info), .texts = std::move(*texts), .brdf = std::move(*brdf), .points = std::move(*points)};
}

Result<MeasuredBrdf> measured_brdf(const StoredScan& scan) {
  if (scan.brdf.rows.empty()) return failure(without_values(scan));
  MeasuredBrdf brdf{.metadata = metadata_of(scan), .channels = {}, .flag_names = all_flag_names(), .points = {}};
  std::map<std::int32_t, double> wavelength_nm;
  for (const PointInfo& info : scan.points) wavelength_nm[info.point.index] = in_nanometres(info.point.wavelength);
  std::map<double, std::uint32_t> channels;
  for (const BrdfRow& row : scan.brdf.rows) {
    const double nm = wavelength_nm[row.point];
    const auto [channel, is_new] = channels.try_emplace(nm, static_cast<std::uint32_t>(channels.size()));
    if (is_new) brdf.channels.push_back(formats::channel_at(nm));
    brdf.points.push_back(point_of(row, channel->second, brdf.flag_names.size()));
  }
  return brdf;
}

std::vector<std::string> notes_on(const StoredScan& scan, const MeasuredBrdf& brdf) {
  std::vector<std::string> notes;
  if (!daemon::is_over(scan.info.state)) {
    notes.push_back(fmt::format("scan {} is {}: these are its values so far", scan.info.id,
                                daemon::scan_state_name(scan.info.state)));
  }
  const std::int64_t missing = scan.info.counts.points - std::ssize(brdf.points);
  if (missing > 0) {
    notes.push_back(fmt::format("{} of {} points have no value, {} of them in the detector's shadow", missing,
                                scan.info.counts.points, scan.info.counts.blocked));
  }
  const std::string flags = flags_of_all(brdf);
  if (!flags.empty()) notes.push_back("every value is flagged: " + flags);
  if (incidences_of(scan) == 1) {
    notes.emplace_back("one theta_i only: under any other the surface is taken to be the same");
  }
  return notes;
}

}  // namespace gonio::analysis
