// Leaving early: the arms go to the next item as soon as the light of the item in hand is integrated, while its frame
// is transferred, reduced and stored.
#include <utility>

#include "daemon/sequencer/sequencer_impl.h"

namespace gonio::daemon {

// Only where nothing but the next item can follow, and where the frame under way is expected to be the last: a wrong
// guess costs a way there and back.
bool Sequencer::Impl::may_leave(const Job& job, Instant now) const {
  const bool goes_on = scan->state == ScanState::Running && scan->holds.empty() && !scan->finish_command &&
                       !scan->finish_asked && !is_in_transition && waiting.empty();
  if (!goes_on || job.kind != Job::Kind::Item || job.frame || visit_is_next_after(job.item, now)) return false;
  if (config.instrument.monitor && !job.monitor) return false;
  return job.measurement->expects_no_more(scan->chooser);
}

void Sequencer::Impl::leave_early(Instant now) {
  if (!may_leave(*scan->job, now)) return;
  const auto next = scan->items.next_after(scan->job->item, now);
  if (!next) return;
  Job ahead = new_job(Job::Kind::Item, now);
  ahead.item = *next;
  if (!aim(ahead)) return;  // said when its turn has come
  scan->ahead = std::move(ahead);
  ask_to_move(*scan->ahead, now);
}

// The frame was the last one, and the item is accepted: what the arms are on the way to is in hand now.
void Sequencer::Impl::take_up_ahead(Instant now) {
  scan->job = std::exchange(scan->ahead, std::nullopt);
  Job& job = *scan->job;
  begin_measurement(job);
  if (job.phase == Job::Phase::InPlace) scan->ledger.enter(job.time.read, now);
  if (job.error) job_failed(Error(*job.error), now);
}

// The frame was not the last one: the arms have left too soon. What they are about is awaited, then they return.
void Sequencer::Impl::go_back(Instant now) {
  drop_ahead(now);
  scan->job->time.idle.device += std::exchange(scan->between.device, {});  // nobody else's
  scan->job->phase = Job::Phase::ToMove;
  scan->job->is_going_back = true;
}

void Sequencer::Impl::drop_ahead(Instant now) {
  if (!scan->ahead) return;
  if (stage_call && stage_call->use == StageUse::Move) stage_call->use = StageUse::Dropped;
  count_as_lost(*std::exchange(scan->ahead, std::nullopt), now);
}

}  // namespace gonio::daemon
