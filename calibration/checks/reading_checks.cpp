// What readings say of the instrument: the dark's history, and exposures that should agree.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "calibration/checks/check_parts.h"

namespace gonio::calibration {
namespace {

using Group = std::vector<reflectance::GroupMember>;

std::string rung_text(const ExposureRung& rung) {
  if (rung.range_pw != 0) return fmt::format("in the range of {:g} W", static_cast<double>(rung.range_pw) * 1e-12);
  return fmt::format("at {} us", rung.exposure_us);
}

// What interpolation over one interval is stated to miss, in the unit of the level.
double stated_drift(const ExposureRung& rung, const DetectorModel& detector) {
  if (detector.power) return detector.power->u_zero * static_cast<double>(rung.range_pw) * 1e-12;
  return detector.u_dark_drift_dn_per_s * static_cast<double>(rung.exposure_us) * 1e-6;
}

// A dark visit beside the line between its neighbours. Of a random walk that misses u in the middle of one interval,
// the middle of two misses sqrt(2) u, and at a part p of both 2 sqrt(2 p (1 - p)) u.
double dark_z(const DarkVisit& before, const DarkVisit& visit, const DarkVisit& after, double drift) {
  const double p = in_seconds(visit.at - before.at) / in_seconds(after.at - before.at);
  const double expected = before.level_dn + p * (after.level_dn - before.level_dn);
  const double variance = visit.u_dn * visit.u_dn + (1.0 - p) * (1.0 - p) * before.u_dn * before.u_dn +
                          p * p * after.u_dn * after.u_dn + 8.0 * p * (1.0 - p) * drift * drift;
  return variance > 0.0 ? (visit.level_dn - expected) / std::sqrt(variance) : 0.0;
}

/// Readings of one attempt or visit, part by part of one exposure each.
std::map<std::int64_t, std::vector<RawReading>> parts_by_attempt(const ScanReadings& scan) {
  std::map<std::int64_t, std::vector<RawReading>> attempts;
  for (const RawReading& reading : scan.readings) {
    if (reading.target != Target::Sample && reading.target != Target::Reference) continue;
    std::map<ExposureRung, RawReading> parts;
    for (const RawFrame& frame : reading.frames) {
      RawReading& part = parts[rung_of(frame)];
      if (part.frames.empty()) {
        part = reading;
        part.frames.clear();
      }
      part.frames.push_back(frame);
    }
    for (auto& [rung, part] : parts) attempts[reading.visit_id].push_back(std::move(part));
  }
  std::erase_if(attempts, [](const auto& attempt) { return attempt.second.size() < 2; });
  return attempts;
}

// Of coefficient n of the fitted linearity, and of the shutter's offset behind them: their correlation is left aside,
// which can only widen what is allowed.
double u_of_fit(const DetectorModel& detector, std::size_t n) {
  const std::size_t size = detector.linearity.coefficients.size() + 1;
  if (detector.linearity.covariance.size() != size * size) return n + 1 == size ? detector.exposure_offset_s.u : 0.0;
  return std::sqrt(std::max(0.0, detector.linearity.covariance[n * size + n]));
}

// Light of one exposure, as one number: linearity, shutter and gain of a range have the sign of their own error.
reflectance::GroupMember exposure_member(const LevelReading& level, const DetectorModel& detector,
                                         std::uint32_t range) {
  enum : std::uint32_t { kLinearity, kShutter, kFit, kFirstRange = kFit + kLinearityTerms };
  const NormalisedReading& r = level.reading;
  const std::size_t terms = detector.linearity.coefficients.size();
  std::vector<reflectance::SharedEffect> shared{
      {kLinearity, per_steradian(r.q * r.mean_net_dn / detector.full_scale_dn * detector.u_linearity)},
      {kShutter, per_steradian(r.q * r.dlnq_dt0 * u_of_fit(detector, terms))}};
  for (std::size_t n = 0; n < terms; ++n) {
    shared.push_back({kFit + static_cast<std::uint32_t>(n), per_steradian(r.dq_dlinearity[n] * u_of_fit(detector, n))});
  }
  if (detector.power) shared.push_back({kFirstRange + range, per_steradian(r.q * detector.power->u_range)});
  return {r.q, level.u, reflectance::SharedEffects(shared)};
}

void scale(Group& group) {
  double unit = 0.0;
  for (const auto& member : group) unit = std::max({unit, std::abs(member.value), member.u_random});
  for (auto& member : group) {
    reflectance::SharedEffects scaled;
    scaled.add(member.shared, 1.0 / unit);
    member = {member.value / unit, member.u_random / unit, std::move(scaled)};
  }
}

}  // namespace

ScanCheck check_dark_history(const CheckInputs& inputs) {
  ScanCheck check{.kind = CheckKind::DarkHistory, .unit = "dark visits between two others"};
  const DetectorModel& detector = inputs.instrument.detector;
  const DarkHistory darks(inputs.scan, detector);
  std::string worst_where;
  for (const auto& [rung, visits] : darks.visits()) {
    const double drift = stated_drift(rung, detector);
    for (std::size_t k = 1; k + 1 < visits.size(); ++k) {
      if (visits[k + 1].at <= visits[k - 1].at) continue;
      ++check.compared;
      const double z = dark_z(visits[k - 1], visits[k], visits[k + 1], drift);
      if (std::abs(z) <= std::abs(check.worst_z)) continue;
      check.worst_z = z;
      worst_where = fmt::format("visit {} {}", visits[k].visit_id, rung_text(rung));
    }
  }
  judge_by_worst(check, check.compared);
  if (check.compared == 0) return check;
  check.finding = fmt::format("{} {}: worst {:+.1f} u beside the line of its neighbours{}{}", check.compared,
                              check.unit, check.worst_z, worst_where.empty() ? "" : ", " + worst_where,
                              check.verdict == CheckVerdict::Failed
                                  ? ": light in the dark, or a dark level that wanders more than is stated"
                                  : "");
  return check;
}

ScanCheck check_exposures(const CheckInputs& inputs) {
  ScanCheck check{.kind = CheckKind::Exposures, .unit = "readings at a second exposure"};
  const DetectorModel& detector = inputs.instrument.detector;
  const ScanHistories histories(inputs.scan, inputs.instrument, {});
  std::map<ExposureRung, std::uint32_t> ranges;  // numbered as they come
  std::vector<Group> groups;
  for (const auto& [attempt, parts] : parts_by_attempt(inputs.scan)) {
    Group group;
    std::set<ExposureRung> rungs;
    for (const RawReading& part : parts) {
      const ExposureRung rung = rung_of(part.frames.front());
      const auto level = level_of(part, histories.context());
      if (!level || !rungs.insert(rung).second) continue;
      const auto range = ranges.try_emplace(rung, static_cast<std::uint32_t>(ranges.size())).first->second;
      group.push_back(exposure_member(*level, detector, range));
    }
    if (group.size() < 2) continue;
    scale(group);
    for (std::size_t k = 1; k < group.size(); ++k) {
      ++check.compared;
      reflectance::SharedEffects apart = group[k].shared;
      apart.add(group[0].shared, -1.0);
      const double u = std::hypot(std::hypot(group[k].u_random, group[0].u_random), size_of(apart));
      const double z = (group[k].value - group[0].value) / u;
      if (std::abs(z) <= std::abs(check.worst_z)) continue;
      check.worst_z = z;
      check.worst_points.clear();
      if (parts[0].point_index) check.worst_points = {*parts[0].point_index};
    }
    groups.push_back(std::move(group));
  }
  judge_groups(check, groups, check.compared);
  if (!check.finding.empty() || check.compared == 0) return check;
  check.finding = fmt::format("{} {}: chi-square {:.1f} for {:.0f} degrees of freedom, worst {:+.1f} u{}",
                              check.compared, check.unit, check.chi_square, check.degrees_of_freedom, check.worst_z,
                              check.verdict == CheckVerdict::Failed
                                  ? ": the detector is less linear than stated, or its shutter's offset another"
                                  : "");
  return check;
}

}  // namespace gonio::calibration
