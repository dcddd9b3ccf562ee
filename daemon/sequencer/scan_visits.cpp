#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "daemon/planner/estimate.h"
#include "daemon/planner/planner.h"
#include "daemon/sequencer/failure_policy.h"
#include "daemon/sequencer/scan_events.h"
#include "daemon/sequencer/sequencer_impl.h"
#include "daemon/sequencer/visit_schedule.h"

namespace gonio::daemon {

namespace {

using calibration::Target;
using stage::Axis;

constexpr int kFewestDarkFrames = 4;
constexpr int kMostDarkFrames = 16;
constexpr std::size_t kBoundariesAhead = 16;  // looked at before a visit is put off

using Place = stage::PerAxis<double>;

// Where the axes stand for an item, coming from `standing`; nothing where they cannot.
std::optional<Place> place_of(const ActiveScan& scan, const ItemKey& item, const Instrument& instrument,
                              const Place& standing) {
  const ScanPoint& point = scan.points[static_cast<std::size_t>(item.point)];
  const auto target = axis_targets(point.geometry, point.wavelength, instrument, standing);
  if (!target) return std::nullopt;
  Place place = standing;
  for (std::size_t a = 0; a < place.size(); ++a) place[a] = (*target)[a].value_or(standing[a]);
  place[stage::index_of(Axis::Carriage)] = in_millimetres(carriage_place(instrument, item.target, point.geometry));
  return place;
}

// The slowest axis counts; ways round a keep-out do not: this weighs places, it moves nothing.
Duration way_between(const Instrument& instrument, const Place& from, const Place& to) {
  Duration slowest{};
  for (const Axis axis : stage::kAllAxes) {
    const std::size_t a = stage::index_of(axis);
    slowest = std::max(slowest, travel_time(instrument.stage.axis(axis), to[a] - from[a]));
  }
  return slowest;
}

Duration detour_by(const Instrument& instrument, const Place& from, const Place& visit, const Place& to) {
  return way_between(instrument, from, visit) + way_between(instrument, visit, to) - way_between(instrument, from, to);
}

VisitKind kind_of(const Job& job) {
  return job.kind == Job::Kind::Reference ? VisitKind::Reference : VisitKind::Check;
}

}  // namespace

// ---- which job is next ----

VisitClocks Sequencer::Impl::visit_clocks() const {
  return {.dark = {.every = scan->policy.dark_every, .last = scan->last_dark, .is_owed = scan->dark_owed},
          .reference = {.every = scan->policy.reference_every,
                        .last = scan->reference_visits.last(),
                        .is_owed = scan->reference_visits.is_owed()},
          .check = {.every = scan->policy.check_every,
                    .last = scan->check_visits.last,
                    .is_owed = !scan->check_visits.since.empty()}};
}

bool Sequencer::Impl::visit_is_next_after(const ItemKey& in_hand, Instant now) const {
  const auto detour = [&](NextJob visit) { return detour_of(visit, in_hand, now); };
  return next_job(visit_clocks(), now, true, detour) != NextJob::Item;
}

void Sequencer::Impl::choose_job(Instant now) {
  const bool is_finishing = scan->state == ScanState::Finishing;
  if (!is_finishing && scan->finish_asked) {
    return transition(ScanEvent::Finish, now, kDaemon, "asked to finish before the interruption");
  }
  const auto item = is_finishing ? std::nullopt : scan->items.next(now);
  const NextJob next = is_finishing ? next_closing_job(visit_clocks())
                                    : next_job(visit_clocks(), now, item.has_value(), [this, now](NextJob visit) {
                                        return detour_of(visit, std::nullopt, now);
                                      });
  switch (next) {
    case NextJob::Item:
      return start_item(*item, now);
    case NextJob::Dark:
      return start_dark(now);
    case NextJob::Reference:
    case NextJob::Check:
      return start_visit(next, now);
    case NextJob::Nothing:
      return is_finishing ? start_park(now) : transition(ScanEvent::Complete, now, kDaemon, "every item is decided");
  }
}

// The boundaries before the latest time of the visit: the next few of this pass, and the turn of the carriage, where a
// visit on the other side costs only what the arms go for it.
Detour Sequencer::Impl::detour_of(NextJob visit, const std::optional<ItemKey>& in_hand, Instant now) const {
  constexpr Duration kNone = Duration::max();
  const Target target = visit == NextJob::Reference ? Target::Reference : Target::Sample;
  const VisitTrack& track = visit == NextJob::Reference ? scan->reference_visits.due() : scan->check_visits;
  const Duration every = visit == NextJob::Reference ? scan->policy.reference_every : scan->policy.check_every;
  std::vector<ItemKey> ahead = scan->items.ahead(kBoundariesAhead + 2);
  if (in_hand && !ahead.empty() && ahead.front() == *in_hand) ahead.erase(ahead.begin());
  const DurationStatistics& time = scan->item_time;
  if (!stage || ahead.empty() || time.count() == 0) return {.here = {}, .least_ahead = kNone};
  const Duration each = seconds(time.mean_s());
  const Instant latest = *track.last + latest_after(every);

  Place standing = positions_of(*stage);
  const auto there = place_of(*scan, {track.at, target}, config.instrument, standing);
  if (!there) return {.here = {}, .least_ahead = kNone};
  Detour detour{.here = kNone, .least_ahead = kNone};
  for (std::size_t k = 0; k < ahead.size() && now + static_cast<std::int64_t>(k) * each <= latest; ++k) {
    const auto next = place_of(*scan, ahead[k], config.instrument, standing);
    if (!next) break;
    const Duration way = detour_by(config.instrument, standing, *there, *next);
    (k == 0 ? detour.here : detour.least_ahead) = k == 0 ? way : std::min(detour.least_ahead, way);
    standing = *next;
  }
  if (ahead.front().target != target && scan->items.turns_at(now, each) <= latest) {
    Place arms_only = *there;
    arms_only[stage::index_of(Axis::Carriage)] = standing[stage::index_of(Axis::Carriage)];
    detour.least_ahead = std::min(detour.least_ahead, 2 * way_between(config.instrument, standing, arms_only));
  }
  return detour;
}

// ---- the dark ----

int Sequencer::Impl::dark_frames() const {
  if (scan->policy.map_frames > 0) return scan->policy.map_frames;
  return std::clamp(scan->most_frames, kFewestDarkFrames, kMostDarkFrames);
}

// The first dark of a run reads the whole ladder: the levels are needed to choose exposures, and whichever rung is used
// later then has a dark on both sides. Later ones read the rungs in use and those between.
void Sequencer::Impl::start_dark(Instant now) {
  const bool is_first = !scan->last_dark && scan->state == ScanState::Running;
  const std::size_t top = scan->chooser.rungs().size() - 1;
  const std::size_t lowest = is_first ? 0 : scan->lowest_rung.value_or(0);
  const std::size_t highest = is_first ? top : scan->highest_rung.value_or(top);
  scan->job = new_job(Job::Kind::Dark, now);
  scan->job->measurement = Measurement::of_dark(lowest, highest, dark_frames());
}

void Sequencer::Impl::accept_dark(Job& job, Instant now) {
  const NewVisit visit{.scan = scan->id,
                       .time = job.time,
                       .readings = job.measurement->readings(),
                       .started = job.started,
                       .pixel_sums = job.complete_sums()};
  scan->end_estimate.add_dark(job.time);
  scan->last_dark = now;
  scan->dark_owed = false;
  scan->visit_failures = 0;
  commit({.at = now, .writes = {visit}, .events = {event_visit(visit)}},
         {.done = [](const CommitReceipt&, Instant) {}, .holds_exposures = true});
}

// ---- the standard and the sample ----

void Sequencer::Impl::start_visit(NextJob visit, Instant now) {
  const bool is_reference = visit == NextJob::Reference;
  const VisitTrack& track = is_reference ? scan->reference_visits.due() : scan->check_visits;
  scan->job = new_job(is_reference ? Job::Kind::Reference : Job::Kind::Check, now);
  scan->job->item = {track.at, is_reference ? Target::Reference : Target::Sample};
  scan->job->chooser = scan->chooser.for_visit(visit_snr(scan->policy.drift_limit), track.rung);
  if (const auto aimed = aim(*scan->job); !aimed) return job_failed(aimed.error(), now);
  begin_measurement(*scan->job);
}

void Sequencer::Impl::accept_visit(Job& job, Instant now) {
  const VisitKind kind = kind_of(job);
  VisitTrack& track = kind == VisitKind::Reference ? scan->reference_visits.at(job.item.point) : scan->check_visits;
  NewVisit visit{.scan = scan->id,
                 .time = job.time,
                 .readings = job.measurement->readings(),
                 .started = job.started,
                 .kind = kind,
                 .level = level_of(track.at, *job.measurement, scan->chooser, config.instrument)};
  // The sample is judged against the standard, where there is one: what both see is the instrument's.
  const bool is_against_standard = kind == VisitKind::Check && scan->policy.reference_every > Duration::zero();
  if (is_against_standard && scan->reference_visits.level()) {
    visit.level = in_units_of(*scan->reference_visits.level(), *visit.level);
  }
  for (const std::size_t rung : job.measurement->used_rungs()) {
    scan->note_rung(rung);
    if (!track.rung) track.rung = rung;
  }
  scan->most_frames = std::max(scan->most_frames, job.measurement->used_frames());
  scan->dark_owed = true;
  scan->visit_failures = 0;
  scan->visit_time.add(job.time.total());
  if (track.level) visit.level->drift = drift_between(*track.level, *visit.level);
  scan->largest_drift = std::max(scan->largest_drift, std::abs(visit.level->drift.value_or(0.0)));
  reopen_since(track, visit, now);
}

// What lies between two visits that differ too much is open again, by the transaction of the visit that saw it.
void Sequencer::Impl::reopen_since(VisitTrack& track, NewVisit& visit, Instant now) {
  std::set<std::int32_t> points;
  std::int64_t kept = 0;
  const bool is_drift = track.level && is_beyond(scan->policy.drift_limit, *track.level, *visit.level);
  if (is_drift && scan->state == ScanState::Running) {
    for (const ItemKey& item : track.since) points.insert(item.point);
  }
  for (const std::int32_t point : points) {
    if (scan->reopened[point] >= scan->policy.drift_rounds) {
      ++kept;
      continue;
    }
    const std::vector<ItemKey> opened = scan->items.reopen(point);
    if (opened.empty()) continue;
    ++scan->reopened[point];
    visit.reopened.insert(visit.reopened.end(), opened.begin(), opened.end());
  }
  for (const ItemKey& item : visit.reopened) {
    scan->failures.erase(item);
    scan->reference_visits.forget(item);
    std::erase(scan->check_visits.since, item);
  }
  StoreTransaction transaction{.at = now, .writes = {visit}, .events = {event_visit(visit)}};
  if (!points.empty()) transaction.events.push_back(event_reopened(visit, scan->policy.drift_limit, kept));
  const VisitLevel before = track.level.value_or(VisitLevel{});
  track = {.at = track.at, .level = visit.level, .since = {}, .last = now, .rung = track.rung};
  commit(std::move(transaction), {.done = [](const CommitReceipt&, Instant) {}, .holds_exposures = true});
  if (kept > 0) keep_in_spite_of_drift(drift_between(before, *visit.level), kept, now);
}

// Measured again as often as the plan allows, and it still drifts: the plan's on_error decides. Kept points are flagged
// by the calibration.
void Sequencer::Impl::keep_in_spite_of_drift(double drift, std::int64_t points, Instant now) {
  const std::string what =
      fmt::format("drift of {:.3g} between two visits, limit {:.3g}: {} points were measured again {} times already",
                  drift, scan->policy.drift_limit, points, scan->policy.drift_rounds);
  if (scan->policy.on_item_error == api::OnItemError::Hold) return add_hold(HoldName::Device, kDaemon, what, now);
  if (scan->policy.on_item_error == api::OnItemError::Fail && !is_in_transition) {
    transition(ScanEvent::Fail, now, kDaemon, what);
  }
}

// A scan without its visits is worth less than it says: they are never skipped.
void Sequencer::Impl::visit_failed(const Error& error, Instant now) {
  const Job job = *std::exchange(scan->job, std::nullopt);
  count_as_lost(job, now);
  if (++scan->visit_failures <= scan->policy.item_retries) return;  // chosen again
  const std::string_view which = job.kind == Job::Kind::Dark ? "dark" : visit_kind_name(kind_of(job));
  add_hold(hold_for(error.code), error.device, std::string(which) + " visit: " + describe(error), now);
}

}  // namespace gonio::daemon
