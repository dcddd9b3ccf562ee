#include "calibration/anchor_history.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

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

void add_visit(AnchorReading& found, const ReferenceVisit* visit, double weight, double level) {
  if (visit == nullptr || weight == 0.0) return;
  found.terms.push_back({.key = {ComponentSource::VisitNoise, visit->visit_id},
                         .name = fmt::format("reference visit {}", visit->visit_id),
                         .u = visit->u,
                         .unit = "1",
                         .per_sd = -weight * visit->u / level});
}

// As a drift between two visits of a scan at equal geometries: change sqrt(p (1 - p)) within the interval, and as much
// again as it changed beyond it.
void add_change(AnchorReading& found, const DriftLevel& at) {
  const double part = at.weight_after * (1.0 - at.weight_after);
  const double u = at.is_between() ? at.wander * std::sqrt(part) : at.change * at.beyond;
  if (u == 0.0) return;
  const std::int64_t before = at.before == nullptr ? -1 : at.before->visit_id;
  const std::int64_t after = at.after == nullptr ? -1 : at.after->visit_id;
  found.terms.push_back(
      {.key = {ComponentSource::Drift, before, after},
       .name = fmt::format("drift between visits {} and {}", before, after),
       .u = u,
       .unit = "1",
       .per_sd = -u / at.level,
       .degrees_of_freedom = at.is_between() ? at.wander_dof : std::numeric_limits<double>::infinity(),
       .is_pattern_known = false});
}

AnchorReading reading_like(const ReferenceVisit& visit, double level) {
  AnchorReading found{.reading = visit.reading, .reading_id = visit.reading_id};
  found.reading.q *= level / visit.level;
  found.reading.u_noise = 0.0;
  found.reading.u_monitor = 0.0;
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
  add_change(found, *between);
  found.is_extrapolated = !between->is_between();
  found.is_large = between->is_large;
  return found;
}

}  // namespace gonio::calibration
