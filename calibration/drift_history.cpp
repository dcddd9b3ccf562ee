#include "calibration/drift_history.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "calibration/visit_search.h"

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

// Of q, relative: what one visit has for itself, but for its darks.
double u_own_of(const NormalisedReading& visit, const InstrumentModel& instrument) {
  const double cosine = std::tan(visit.geometry.theta_i.si()) * instrument.angles.u_repeat.si();
  return std::hypot(std::hypot(visit.u_noise, visit.u_monitor) / visit.q, instrument.lamp.u_reproducibility, cosine);
}

// Of q, relative.
double u_of_darks(const NormalisedReading& visit) {
  double variance = 0.0;
  for (const DarkShare& share : visit.darks) {
    const DarkLevel& dark = share.level;
    if (dark.before != nullptr) {
      variance += std::pow(share.dq_dlevel * (1.0 - dark.weight_after) * dark.before->u_dn, 2);
    }
    if (dark.after != nullptr) variance += std::pow(share.dq_dlevel * dark.weight_after * dark.after->u_dn, 2);
  }
  return std::sqrt(variance) / visit.q;
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
    const double u_own = level * u_own_of(*visit, instrument);
    visits_.push_back({.visit_id = id,
                       .at = reading.at,
                       .level = level,
                       .u = std::hypot(u_own, level * u_of_darks(*visit)),
                       .u_own = u_own,
                       .reading = *visit,
                       .reading_id = reading.id});
  }
  std::ranges::sort(visits_, {}, &ReferenceVisit::at);
  find_wander();
  for (std::size_t n = 0; n + 1 < visits_.size(); ++n) intervals_.push_back(between(n));
}

// What the visit lies off the line between its neighbours, and the visits' own noise of that.
DriftHistory::Off DriftHistory::off_line(std::size_t n) const {
  const ReferenceVisit& a = visits_[n - 1];
  const ReferenceVisit& b = visits_[n];
  const ReferenceVisit& c = visits_[n + 1];
  const double before = in_seconds(b.at - a.at);
  const double after = in_seconds(c.at - b.at);
  const double w = before / (before + after);
  return {.r = b.level - (1.0 - w) * a.level - w * c.level,
          .noise2 = b.u * b.u + (1.0 - w) * (1.0 - w) * a.u * a.u + w * w * c.u * c.u,
          .bridge_s = before * after / (before + after)};
}

void DriftHistory::find_wander() {
  constexpr std::size_t kFewest = 4;  // from a single inner visit nothing is known
  if (visits_.size() < kFewest) return;
  for (std::size_t n = 1; n < visits_.size(); ++n) {
    if (!(visits_[n].at > visits_[n - 1].at)) return;
  }
  std::vector<Off> offs(visits_.size());  // of the first and the last: 0
  for (std::size_t n = 1; n + 1 < visits_.size(); ++n) offs[n] = off_line(n);
  std::vector<double> steps(visits_.size() - 1, 0.0);
  while (take_out_step(offs, steps)) continue;
  double sum = 0.0;
  for (std::size_t n = 1; n + 1 < offs.size(); ++n) {
    if (offs[n].is_taken_out) continue;
    sum += (offs[n].r * offs[n].r - offs[n].noise2) / offs[n].bridge_s;
    wander_dof_ += 1.0;
  }
  const double rate = wander_dof_ > 0.0 ? std::max(0.0, sum / wander_dof_) : 0.0;
  for (std::size_t n = 0; n + 1 < visits_.size(); ++n) {
    wanders_.push_back({.usual = std::sqrt(rate * in_seconds(visits_[n + 1].at - visits_[n].at)), .step = steps[n]});
  }
}

// The largest step that stands clear of all the rest: its size is kept for its interval, its visits no longer count.
bool DriftHistory::take_out_step(std::vector<Off>& offs, std::vector<double>& steps) const {
  constexpr double kClear = 16.0;  // four standard deviations, squared
  std::size_t largest = 0;
  double size = 0.0;
  for (std::size_t n = 0; n < steps.size(); ++n) {
    const double here = steps[n] == 0.0 ? step_within(offs, n) : 0.0;
    if (here > size) {
      size = here;
      largest = n;
    }
  }
  if (size == 0.0) return false;
  double rest = 0.0;
  double count = 0.0;
  for (std::size_t n = 1; n + 1 < offs.size(); ++n) {
    if (offs[n].is_taken_out || n == largest || n == largest + 1) continue;
    rest += std::max(offs[n].r * offs[n].r, offs[n].noise2) / offs[n].bridge_s;
    count += 1.0;
  }
  const double seconds = in_seconds(visits_[largest + 1].at - visits_[largest].at);
  if (count == 0.0 || size * size / seconds < kClear * rest / count) return false;
  steps[largest] = size;
  for (const std::size_t n : {largest, largest + 1}) {
    if (n > 0 && n + 1 < offs.size()) offs[n].is_taken_out = true;
  }
  return true;
}

// A step within interval n throws the visit before it off to one side and the one after it to the other, each by its
// part; within the first or last interval there is one such visit only.
double DriftHistory::step_within(const std::vector<Off>& offs, std::size_t n) const {
  if (offs[n].is_taken_out || offs[n + 1].is_taken_out) return 0.0;
  const bool is_first = n == 0;
  const bool is_last = n + 2 == visits_.size();
  const Off& before = offs[is_first ? 1 : n];
  const Off& after = offs[is_last ? n : n + 1];
  double size = 0.0;
  if (is_first || is_last) {
    const Off& own = is_first ? before : after;
    const Off& next = offs[is_first ? 2 : n - 1];
    size = std::max(0.0, std::abs(own.r) - (own.r * next.r < 0.0 ? std::abs(next.r) : 0.0));
  } else if (before.r * after.r < 0.0) {
    size = std::min(std::abs(before.r), std::abs(after.r));
  }
  constexpr double kPart = 2.0;  // of a step between visits at even distances, half
  return kPart * std::sqrt(std::max(0.0, size * size - std::max(before.noise2, after.noise2)));
}

DriftLevel DriftHistory::between(std::size_t n) const {
  const ReferenceVisit& a = visits_[n];
  const ReferenceVisit& b = visits_[n + 1];
  constexpr double kCertain = 3.0;
  const double change = b.level - a.level;
  const double u = std::hypot(a.u, b.u);
  DriftLevel found{.change = std::sqrt(std::max(0.0, change * change - u * u)),
                   .is_large = limit_ && std::abs(change) > std::max(*limit_ * a.level, kCertain * u)};
  found.wander = found.change;
  if (!wanders_.empty()) {
    found.wander = std::max(wanders_[n].usual, wanders_[n].step);
    if (wanders_[n].usual > wanders_[n].step) found.wander_dof = wander_dof_;
  }
  return found;
}

std::optional<DriftLevel> DriftHistory::at(Instant when) const {
  std::optional<DriftLevel> found;
  find(when, found);
  return found;
}

void DriftHistory::find(Instant when, std::optional<DriftLevel>& at) const {
  if (visits_.size() < 2) return at.reset();
  const auto next = visits_.begin() + static_cast<std::ptrdiff_t>(first_not_before(visits_, when));
  const bool is_early = next == visits_.begin();
  const bool is_late = next == visits_.end();
  const ReferenceVisit& a = is_early ? visits_.front() : *(is_late ? next - 2 : next - 1);
  const ReferenceVisit& b = is_early ? visits_[1] : *(is_late ? next - 1 : next);
  DriftLevel& found = at.emplace(intervals_[static_cast<std::size_t>(&a - visits_.data())]);
  const double w = in_seconds(when - a.at) / in_seconds(b.at - a.at);
  if (is_early || is_late) {
    found.level = is_early ? a.level : b.level;
    (is_early ? found.after : found.before) = is_early ? &a : &b;
    found.weight_after = is_early ? 1.0 : 0.0;
    found.beyond = is_early ? -w : w - 1.0;
    return;
  }
  found.level = a.level + w * (b.level - a.level);
  found.before = &a;
  found.after = &b;
  found.weight_after = w;
}

}  // namespace gonio::calibration
