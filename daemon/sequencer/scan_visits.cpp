#include <algorithm>
#include <utility>

#include "daemon/sequencer/failure_policy.h"
#include "daemon/sequencer/scan_events.h"
#include "daemon/sequencer/sequencer_impl.h"
#include "daemon/sequencer/visit_schedule.h"

namespace gonio::daemon {

namespace {

constexpr int kFewestDarkFrames = 4;
constexpr int kMostDarkFrames = 16;

}  // namespace

// ---- which job is next ----

VisitClocks Sequencer::Impl::visit_clocks() const {
  return {.dark = {.every = scan->policy.dark_every, .last = scan->last_dark, .is_owed = scan->dark_owed}};
}

bool Sequencer::Impl::visit_may_be_next(Instant now) const {
  return next_job(visit_clocks(), now, true, [](NextJob) { return Detour{}; }) != NextJob::Item;
}

void Sequencer::Impl::choose_job(Instant now) {
  if (scan->state == ScanState::Finishing) {
    return next_closing_job(visit_clocks()) == NextJob::Dark ? start_dark(now) : start_park(now);
  }
  if (scan->finish_asked) return transition(ScanEvent::Finish, now, kDaemon, "asked to finish before the interruption");
  const auto item = scan->items.next(now);
  const NextJob next = next_job(visit_clocks(), now, item.has_value(), [](NextJob) { return Detour{}; });
  if (next == NextJob::Nothing) return transition(ScanEvent::Complete, now, kDaemon, "every item is decided");
  if (next == NextJob::Dark) return start_dark(now);
  start_item(*item, now);
}

// ---- the dark ----

int Sequencer::Impl::dark_frames() const {
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
  const NewVisit visit{
      .scan = scan->id, .time = job.time, .readings = job.measurement->readings(), .started = job.started};
  scan->end_estimate.add_dark(job.time);
  scan->last_dark = now;
  scan->dark_owed = false;
  scan->dark_failures = 0;
  commit({.at = now, .writes = {visit}, .events = {event_dark_visit(visit)}},
         {.done = [](const CommitReceipt&, Instant) {}, .holds_exposures = true});
}

// A scan without its dark is worth nothing: never skipped.
void Sequencer::Impl::dark_failed(const Error& error, Instant now) {
  count_as_lost(*std::exchange(scan->job, std::nullopt), now);
  if (++scan->dark_failures <= scan->policy.item_retries) return;  // chosen again
  add_hold(hold_for(error.code), error.device, "dark visit: " + describe(error), now);
}

}  // namespace gonio::daemon
