#include "daemon/sequencer/visit_schedule.h"

namespace gonio::daemon {

namespace {

Duration part_of(Duration every, double part) {
  return seconds(in_seconds(every) * part);
}

bool is_wanted(const VisitClock& clock) {
  return clock.every > Duration::zero();
}

bool is_dark_due(const VisitClock& dark, Instant now) {
  if (!dark.last) return true;
  return is_wanted(dark) && now - *dark.last >= dark.every;
}

// Of a visit to which the arms must go.
bool is_its_place(const VisitClock& clock, NextJob visit, Instant now, const std::function<Detour(NextJob)>& detour) {
  if (!is_wanted(clock)) return false;
  if (!clock.last) return true;
  const Duration since = now - *clock.last;
  if (since >= latest_after(clock.every)) return true;
  if (since < part_of(clock.every, 1.0 - kVisitSlack)) return false;
  const Detour way = detour(visit);
  return way.here <= way.least_ahead;
}

// A check stands beside a reference visit, where there are such.
NextJob check_after_reference(const VisitClocks& clocks) {
  const bool is_beside = !is_wanted(clocks.reference) || (clocks.reference.last && !clocks.reference.is_owed);
  return is_beside ? NextJob::Check : NextJob::Reference;
}

bool closes(const VisitClock& clock) {
  return is_wanted(clock) && clock.is_owed;
}

}  // namespace

Duration latest_after(Duration every) {
  return part_of(every, 1.0 + kVisitSlack);
}

NextJob next_job(const VisitClocks& clocks, Instant now, bool has_open_item,
                 const std::function<Detour(NextJob)>& detour) {
  if (!has_open_item) {
    if (closes(clocks.reference)) return NextJob::Reference;
    if (closes(clocks.check)) return check_after_reference(clocks);
    return NextJob::Nothing;
  }
  if (is_dark_due(clocks.dark, now)) return NextJob::Dark;
  if (is_its_place(clocks.reference, NextJob::Reference, now, detour)) return NextJob::Reference;
  if (is_its_place(clocks.check, NextJob::Check, now, detour)) return check_after_reference(clocks);
  return NextJob::Item;
}

NextJob next_closing_job(const VisitClocks& clocks) {
  const bool needs_light = closes(clocks.reference) || closes(clocks.check);
  if (needs_light && !clocks.dark.last) return NextJob::Dark;  // its level is known by a dark of this run only
  if (closes(clocks.reference)) return NextJob::Reference;
  if (closes(clocks.check)) return check_after_reference(clocks);
  return clocks.dark.is_owed ? NextJob::Dark : NextJob::Nothing;
}

}  // namespace gonio::daemon
