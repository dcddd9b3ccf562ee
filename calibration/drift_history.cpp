#include "calibration/drift_history.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace gonio::calibration {
namespace {

// A visit at several exposures is several readings.
std::map<std::int64_t, RawReading> visits_of_standard(const ScanReadings& scan) {
  std::map<std::int64_t, RawReading> visits;
  std::optional<std::int32_t> point;
  for (const RawReading& reading : scan.readings) {
    if (reading.target != Target::Reference || !reading.visited_point) continue;
    if (point.value_or(*reading.visited_point) != *reading.visited_point) continue;
    point = reading.visited_point;
    const auto [visit, is_first] = visits.try_emplace(reading.visit_id, reading);
    if (is_first) continue;
    RawReading& all = visit->second;
    all.frames.insert(all.frames.end(), reading.frames.begin(), reading.frames.end());
    const auto share = static_cast<double>(reading.frames.size()) / static_cast<double>(all.frames.size());
    all.at += seconds(share * in_seconds(reading.at - all.at));
  }
  return visits;
}

// Of q, relative: what one visit has for itself.
double u_of(const NormalisedReading& visit, const InstrumentModel& instrument) {
  double variance = visit.u_noise * visit.u_noise + visit.u_monitor * visit.u_monitor;
  for (const DarkShare& share : visit.darks) {
    const DarkLevel& dark = share.level;
    if (dark.before != nullptr) {
      variance += std::pow(share.dq_dlevel * (1.0 - dark.weight_after) * dark.before->u_dn, 2);
    }
    if (dark.after != nullptr) variance += std::pow(share.dq_dlevel * dark.weight_after * dark.after->u_dn, 2);
  }
  const double cosine = std::tan(visit.geometry.theta_i.si()) * instrument.angles.u_repeat.si();
  return std::hypot(std::sqrt(variance) / visit.q, instrument.lamp.u_reproducibility, cosine);
}

}  // namespace

DriftHistory::DriftHistory(const ScanReadings& scan, const ReadingContext& context, const InstrumentModel& instrument)
    : limit_(scan.drift_limit) {
  double unit = 0.0;
  for (const auto& [id, reading] : visits_of_standard(scan)) {
    const auto visit = normalise(reading, context);
    if (!visit || !(visit->q > 0.0)) continue;  // saturated, or dark: it says nothing of the response
    if (unit == 0.0) unit = visit->q;
    const double level = visit->q / unit;
    visits_.push_back({.visit_id = id,
                       .at = reading.at,
                       .level = level,
                       .u = level * u_of(*visit, instrument),
                       .reading = *visit,
                       .reading_id = reading.id});
  }
  std::ranges::sort(visits_, {}, &ReferenceVisit::at);
  find_wander();
}

void DriftHistory::find_wander() {
  constexpr std::size_t kFewest = 4;  // from a single inner visit nothing is known
  if (visits_.size() < kFewest) return;
  double sum = 0.0;
  for (std::size_t n = 1; n + 1 < visits_.size(); ++n) {
    const ReferenceVisit& a = visits_[n - 1];
    const ReferenceVisit& b = visits_[n];
    const ReferenceVisit& c = visits_[n + 1];
    const double before = in_seconds(b.at - a.at);
    const double after = in_seconds(c.at - b.at);
    if (!(before > 0.0) || !(after > 0.0)) return;
    const double w = before / (before + after);
    const double off = b.level - (1.0 - w) * a.level - w * c.level;
    const double noise2 = b.u * b.u + (1.0 - w) * (1.0 - w) * a.u * a.u + w * w * c.u * c.u;
    sum += (off * off - noise2) * (before + after) / (before * after);
  }
  wander_dof_ = static_cast<double>(visits_.size() - 2);
  wander_rate_ = std::max(0.0, sum / wander_dof_);
}

DriftLevel DriftHistory::between(const ReferenceVisit& a, const ReferenceVisit& b) const {
  constexpr double kCertain = 3.0;
  const double change = b.level - a.level;
  const double u = std::hypot(a.u, b.u);
  DriftLevel found{.change = std::sqrt(std::max(0.0, change * change - u * u)),
                   .is_large = limit_ && std::abs(change) > std::max(*limit_ * a.level, kCertain * u)};
  found.wander = found.change;
  if (wander_rate_) {
    found.wander = std::sqrt(*wander_rate_ * in_seconds(b.at - a.at));
    found.wander_dof = wander_dof_;
  }
  return found;
}

std::optional<DriftLevel> DriftHistory::at(Instant when) const {
  if (visits_.size() < 2) return std::nullopt;
  const auto next = std::ranges::lower_bound(visits_, when, {}, &ReferenceVisit::at);
  const bool is_early = next == visits_.begin();
  const bool is_late = next == visits_.end();
  const ReferenceVisit& a = is_early ? visits_.front() : *(is_late ? next - 2 : next - 1);
  const ReferenceVisit& b = is_early ? visits_[1] : *(is_late ? next - 1 : next);
  DriftLevel found = between(a, b);
  const double w = in_seconds(when - a.at) / in_seconds(b.at - a.at);
  if (is_early || is_late) {
    found.level = is_early ? a.level : b.level;
    (is_early ? found.after : found.before) = is_early ? &a : &b;
    found.weight_after = is_early ? 1.0 : 0.0;
    found.beyond = is_early ? -w : w - 1.0;
    return found;
  }
  found.level = a.level + w * (b.level - a.level);
  found.before = &a;
  found.after = &b;
  found.weight_after = w;
  return found;
}

}  // namespace gonio::calibration
