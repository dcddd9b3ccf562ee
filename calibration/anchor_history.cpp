#include "calibration/anchor_history.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "calibration/drift_bridge.h"

namespace gonio::calibration {
namespace {

std::int64_t key_of(Wavelength wavelength) {
  return std::llround(in_nanometres(wavelength) * 1e3);
}

// Visits of two wavelengths are two histories, each at a point of its own.
std::map<std::int64_t, ScanReadings> visits_by_wavelength(const ScanReadings& scan) {
  std::map<std::int64_t, ScanReadings> parts;
  for (const RawReading& reading : scan.readings) {
    if (reading.target != Target::Reference || !reading.visited_point) continue;
    ScanReadings& part = parts[key_of(reading.wavelength)];
    part.drift_limit = scan.drift_limit;
    part.readings.push_back(reading);
  }
  return parts;
}

// A visit's part in q at the moment: its own noise as a term, its darks as those of the reading.
void add_visit(AnchorReading& found, const ReferenceVisit* visit, double weight, double level) {
  if (visit == nullptr || weight == 0.0) return;
  found.terms.push_back({.key = {ComponentSource::VisitNoise, visit->visit_id},
                         .name = fmt::format("reference visit {}", visit->visit_id),
                         .u = visit->u_own,
                         .unit = "1",
                         .per_sd = -weight * visit->u_own / level,
                         .divides = true});
  for (DarkShare share : visit->reading.darks) {
    share.dq_dlevel *= weight;
    share.light_share *= weight;
    found.reading.darks.push_back(share);
  }
}

std::int64_t id_of_visit(const ReferenceVisit* visit) {
  return visit == nullptr ? -1 : visit->visit_id;
}

// Before the first visit or after the last: as much again as it changed in the nearest interval.
void add_onward(AnchorReading& found, const DriftLevel& at) {
  const double u = at.change * at.beyond;
  const std::int64_t before = id_of_visit(at.before);
  const std::int64_t after = id_of_visit(at.after);
  found.terms.push_back({.key = {ComponentSource::Drift, before, after},
                         .name = fmt::format("drift between visits {} and {}", before, after),
                         .u = u,
                         .unit = "1",
                         .per_sd = -u / at.level,
                         .is_pattern_known = false,
                         .divides = true});
}

// What a line between two visits misses (drift_bridge.h).
void add_missed(AnchorReading& found, const DriftLevel& at) {
  const std::int64_t before = id_of_visit(at.before);
  const std::int64_t after = id_of_visit(at.after);
  const BridgeParts bridge = bridge_at(at.weight_after);
  for (std::size_t k = 0; k < kBridgeModes; ++k) {
    found.terms.push_back({.key = {ComponentSource::Drift, before, after, static_cast<std::int64_t>(k) + 1},
                           .name = fmt::format("drift between visits {} and {}, course {}", before, after, k + 1),
                           .u = at.wander,
                           .unit = "1",
                           .per_sd = -at.wander * bridge.mode[k] / at.level,
                           .degrees_of_freedom = at.wander_dof,
                           .is_of_the_wander = std::isfinite(at.wander_dof),
                           .divides = true});
  }
  found.u_drift_rest = at.wander * bridge.rest / at.level;
  found.drift_rest_dof = at.wander_dof;
}

AnchorReading reading_like(const ReferenceVisit& visit, double level) {
  AnchorReading found{.reading = visit.reading, .reading_id = visit.reading_id};
  found.reading.q *= level / visit.level;
  found.reading.u_noise = 0.0;
  found.reading.u_monitor = 0.0;
  found.reading.darks.clear();
  return found;
}

}  // namespace

AnchorHistory::AnchorHistory(const ScanReadings& scan, const ReadingContext& context,
                             const InstrumentModel& instrument) {
  for (const auto& [wavelength, visits] : visits_by_wavelength(scan)) {
    by_wavelength_.try_emplace(wavelength, visits, context, instrument);
  }
}

Result<AnchorReading> AnchorHistory::at(Wavelength wavelength, Instant when) const {
  const auto line = by_wavelength_.find(key_of(wavelength));
  if (line == by_wavelength_.end() || line->second.visits().empty()) {
    return failure(Error{.code = ErrorCode::IncompleteData,
                         .device = "detector",
                         .tried = fmt::format("calibrate against the anchor at {:g} nm", in_nanometres(wavelength)),
                         .seen = "no usable visit of the standard at this wavelength",
                         .limit = "at least one"});
  }
  const std::optional<DriftLevel> between = line->second.at(when);
  if (!between) {
    const ReferenceVisit& only = line->second.visits().front();
    AnchorReading found = reading_like(only, only.level);
    add_visit(found, &only, 1.0, only.level);
    found.is_extrapolated = true;
    return found;
  }
  const bool is_after_nearer = between->before == nullptr || (between->after != nullptr && between->weight_after > 0.5);
  AnchorReading found = reading_like(is_after_nearer ? *between->after : *between->before, between->level);
  add_visit(found, between->before, 1.0 - between->weight_after, between->level);
  add_visit(found, between->after, between->weight_after, between->level);
  between->is_between() ? add_missed(found, *between) : add_onward(found, *between);
  found.is_extrapolated = !between->is_between();
  found.is_large = between->is_large;
  return found;
}

}  // namespace gonio::calibration
