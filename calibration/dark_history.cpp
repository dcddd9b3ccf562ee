#include "calibration/dark_history.h"

#include <algorithm>
#include <cmath>

#include "calibration/visit_search.h"

namespace gonio::calibration {
namespace {

struct Sums {
  Instant at{};
  double frames = 0.0;
  double level = 0.0;       // sums over frames
  double raw_level = 0.0;   // before any map: what the dark current's shot noise goes with
  double variance = 0.0;    // spatial
  double per_pixels = 0.0;  // 1 / n
  double mean_w2 = 0.0;     // of a radiometer: the variances of the readings
};

double seconds_of(ExposureRung rung) {
  return static_cast<double>(rung.exposure_us) * 1e-6;
}

// The dark current, in DN/s, from the levels of one visit at its shortest and longest exposure of one gain; nothing
// when it has only one: an offset and a current look the same then.
std::optional<double> dark_rate(const std::map<ExposureRung, Sums>& rungs, std::int64_t gain_mdb) {
  std::optional<std::pair<double, double>> shortest, longest;  // exposure, level
  for (const auto& [rung, sums] : rungs) {
    if (rung.gain_mdb != gain_mdb) continue;
    const std::pair<double, double> here{seconds_of(rung), sums.raw_level / sums.frames};
    if (!shortest) shortest = here;
    longest = here;  // rungs ascend by exposure
  }
  if (!shortest || longest->first <= shortest->first) return std::nullopt;
  return (longest->second - shortest->second) / (longest->first - shortest->first);
}

// Read noise and the dark current's shot noise. With one exposure only, the spatial spread of the dark frame stands in
// for it: it holds the fixed pattern too, so it is never too small.
double pixel_variance(const DetectorModel& detector, ExposureRung rung, const Sums& sums, std::optional<double> rate) {
  const double read = detector.read_noise_dn * detector.read_noise_dn;
  if (!rate) return std::max(read, sums.variance / sums.frames);
  const double gain = std::pow(10.0, static_cast<double>(rung.gain_mdb) * 1e-3 / 20.0);
  return read + std::max(0.0, *rate) * seconds_of(rung) * gain / detector.electrons_per_dn;
}

// How much more the dark may have wandered at a distance `beyond` from the last visit than in the middle of an interval
// of length `spacing`: a random walk's deviation is sigma sqrt(beyond) there and sigma sqrt(spacing) / 2 here.
double widening(Duration beyond, std::optional<Duration> spacing) {
  constexpr double kAsFarAsOneInterval = 2.0;
  if (!spacing || spacing->count() <= 0) return kAsFarAsOneInterval;
  return std::max(1.0, 2.0 * std::sqrt(in_seconds(beyond) / in_seconds(*spacing)));
}

}  // namespace

ExposureRung rung_of(const RawFrame& frame) {
  if (frame.power) return {.range_pw = std::llround(frame.power->range_w * 1e12)};
  return {.exposure_us = std::llround(frame.exposure_s * 1e6), .gain_mdb = std::llround(frame.gain_db * 1e3)};
}

DarkHistory::DarkHistory(const ScanReadings& scan, const DetectorModel& detector) {
  std::map<std::pair<Instant, std::int64_t>, std::map<ExposureRung, Sums>> by_visit;
  std::map<std::int64_t, Instant> starts;
  for (const RawReading& reading : scan.readings) {
    if (reading.target != Target::Dark) continue;
    const Instant start = starts.emplace(reading.visit_id, reading.at).first->second;
    for (const RawFrame& frame : reading.frames) {
      Sums& sums = by_visit[{start, reading.visit_id}][rung_of(frame)];
      if (sums.frames == 0.0) sums.at = reading.at;
      sums.frames += 1.0;
      if (frame.power) {
        sums.level += frame.power->mean_w;
        sums.mean_w2 += noise_variance_w2(detector.power.value_or(PowerModel{}), *frame.power);
        continue;
      }
      sums.level += frame.signal_dn();
      sums.raw_level += frame.region.mean;
      sums.variance += frame.region.m2;
      sums.per_pixels += 1.0 / frame.region.n;
    }
  }
  for (const auto& [visit, rungs] : by_visit) {
    for (const auto& [rung, sums] : rungs) {
      if (rung.range_pw != 0) {
        visits_[rung].push_back({.visit_id = visit.second,
                                 .at = sums.at,
                                 .level_dn = sums.level / sums.frames,
                                 .u_dn = std::sqrt(sums.mean_w2) / sums.frames});
        continue;
      }
      const double variance = pixel_variance(detector, rung, sums, dark_rate(rungs, rung.gain_mdb));
      visits_[rung].push_back({.visit_id = visit.second,
                               .at = sums.at,
                               .level_dn = sums.level / sums.frames,
                               .u_dn = std::sqrt(variance * sums.per_pixels) / sums.frames,
                               .pixel_variance_dn2 = variance});
    }
  }
}

std::optional<DarkLevel> DarkHistory::at(ExposureRung rung, Instant when) const {
  DarkLevel level;
  return find(rung, when, level) ? std::optional(level) : std::nullopt;
}

bool DarkHistory::find(ExposureRung rung, Instant when, DarkLevel& level) const {
  const auto found = visits_.find(rung);
  if (found == visits_.end()) return false;
  const std::vector<DarkVisit>& visits = found->second;
  const auto next = visits.begin() + static_cast<std::ptrdiff_t>(first_not_before(visits, when));
  if (next != visits.begin() && next != visits.end()) {
    const DarkVisit& a = *(next - 1);
    const DarkVisit& b = *next;
    const double w = in_seconds(when - a.at) / in_seconds(b.at - a.at);
    level.level_dn = a.level_dn + w * (b.level_dn - a.level_dn);
    level.pixel_variance_dn2 = a.pixel_variance_dn2 + w * (b.pixel_variance_dn2 - a.pixel_variance_dn2);
    level.before = &a;
    level.after = &b;
    level.weight_after = w;
    level.drift_widening = 1.0;
    return true;
  }
  const bool early = next == visits.begin();
  const DarkVisit& nearest = early ? visits.front() : visits.back();
  std::optional<Duration> spacing;
  if (visits.size() > 1) {
    spacing = early ? visits[1].at - visits[0].at : visits.back().at - visits[visits.size() - 2].at;
  }
  level = {.level_dn = nearest.level_dn,
           .pixel_variance_dn2 = nearest.pixel_variance_dn2,
           .before = early ? nullptr : &nearest,
           .after = early ? &nearest : nullptr,
           .weight_after = early ? 1.0 : 0.0,
           .drift_widening = widening(early ? nearest.at - when : when - nearest.at, spacing)};
  return true;
}

}  // namespace gonio::calibration
