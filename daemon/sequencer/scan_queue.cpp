// Whose turn it is: the queue, and scans that another one of higher priority has set aside.
#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "daemon/sequencer/scan_events.h"
#include "daemon/sequencer/sequencer_impl.h"
#include "daemon/sequencer/visit_schedule.h"

namespace gonio::daemon {

namespace {

bool goes_before(const ActiveScan& a, const ActiveScan& b) {
  if (a.turn.priority != b.turn.priority) return a.turn.priority > b.turn.priority;
  return a.id < b.id;
}

bool may_start(const ActiveScan& waits, Instant now) {
  return waits.holds.empty() && (!waits.turn.start || waits.turn.start->at <= now);
}

}  // namespace

std::deque<ActiveScan>::iterator Sequencer::Impl::next_in_queue(Instant now) {
  auto best = queue.end();
  for (auto waits = queue.begin(); waits != queue.end(); ++waits) {
    if (may_start(*waits, now) && (best == queue.end() || goes_before(*waits, *best))) best = waits;
  }
  return best;
}

// The scan in the queue that asks to run inside of one of this priority.
const ActiveScan* Sequencer::Impl::urgent(int priority, Instant now) const {
  const ActiveScan* best = nullptr;
  for (const ActiveScan& waits : queue) {
    if (!waits.turn.preempts || waits.turn.priority <= priority || !may_start(waits, now)) continue;
    if (best == nullptr || goes_before(waits, *best)) best = &waits;
  }
  return best;
}

std::optional<Instant> Sequencer::Impl::next_start(Instant now) const {
  std::optional<Instant> next;
  for (const ActiveScan& waits : queue) {
    if (!waits.turn.start || waits.turn.start->at <= now || !waits.holds.empty()) continue;
    next = std::min(next.value_or(waits.turn.start->at), waits.turn.start->at);
  }
  return next;
}

std::vector<ScanId> Sequencer::Impl::queue_in_order() const {
  std::vector<const ActiveScan*> waiting_scans;
  for (const ActiveScan& waits : queue) waiting_scans.push_back(&waits);
  std::sort(waiting_scans.begin(), waiting_scans.end(), [](auto* a, auto* b) { return goes_before(*a, *b); });
  std::vector<ScanId> order;
  for (const ActiveScan* waits : waiting_scans) order.push_back(waits->id);
  return order;
}

void Sequencer::Impl::activate_next(Instant now) {
  const bool another_goes_first =
      !aside.empty() && aside.back().is_only_preempted() && urgent(aside.back().turn.priority, now) != nullptr;
  if (!aside.empty() && !another_goes_first) return return_from_aside(now);
  const auto next = next_in_queue(now);
  if (next == queue.end()) return;
  scan.emplace(std::move(*next));
  scan->ledger.restart(now);
  queue.erase(next);
}

// It goes on by itself; one that was found at start-up is asked by the policy for restarts instead.
void Sequencer::Impl::return_from_aside(Instant now) {
  scan.emplace(std::move(aside.back()));
  aside.pop_back();
  if (scan->is_found) scan->ledger.restart(now);
  if (scan->is_found || !scan->has_hold(HoldName::Preempted)) return;
  end_holds(*scan, {HoldName::Preempted}, kDaemon, "the scan that ran first is over", now, std::nullopt);
}

// A more urgent scan waits. At a point boundary: what the reference owes is measured and the visits made first, so that
// nothing of this scan waits half done. True when it holds from now on.
bool Sequencer::Impl::makes_way(Instant now) {
  if (scan->state != ScanState::Running || scan->finish_asked) return false;
  const ActiveScan* first = urgent(scan->turn.priority, now);
  if (first == nullptr) return false;
  const bool has_sample =
      scan->job && scan->job->kind == Job::Kind::Item && scan->job->item.target == calibration::Target::Sample;
  if (scan->job && !has_sample) return false;  // what is owed is on its way
  if (has_sample) drop_job(now);               // it only moves: nothing is lost
  if (scan->items.owes_reference()) {
    scan->items.close_block();
    return false;
  }
  const NextJob owed = next_closing_job(visit_clocks());
  if (owed != NextJob::Nothing) {
    owed == NextJob::Dark ? start_dark(now) : start_visit(owed, now);
    return false;
  }
  add_hold(HoldName::Preempted, kDaemon,
           fmt::format("scan {} of priority {} runs first", first->id, first->turn.priority), now);
  return true;
}

// Holding for nothing but the more urgent one, with nothing open: the instrument is the other's.
void Sequencer::Impl::set_aside(Instant now) {
  if (!scan->has_hold(HoldName::Preempted) || !channels_are_free() || !commits.empty() || by_hand) return;
  if (!scan->is_only_preempted()) {
    // Somebody or something else holds the instrument as well: nothing may run on it.
    return end_holds(*scan, {HoldName::Preempted}, kDaemon, "held for another reason", now, std::nullopt);
  }
  aside.push_back(std::move(*scan));
  scan.reset();
}

void Sequencer::Impl::take_up(UnfinishedScan stored) {
  ActiveScan unfinished(std::move(stored), config.instrument);
  unfinished.is_found = unfinished.state != ScanState::Queued;
  if (!unfinished.is_found) {
    queue.push_back(std::move(unfinished));
    return;
  }
  // The one without the hold had the instrument; of those set aside the last returns first.
  const auto since = [](const ActiveScan& one) {
    const auto hold =
        std::find_if(one.holds.begin(), one.holds.end(), [](const Hold& h) { return h.name == HoldName::Preempted; });
    return hold == one.holds.end() ? Instant::max() : hold->since;
  };
  const auto place = std::find_if(aside.begin(), aside.end(),
                                  [&](const ActiveScan& other) { return since(other) > since(unfinished); });
  aside.insert(place, std::move(unfinished));
}

// ---- who is meant ----

ActiveScan* Sequencer::Impl::find_scan(ScanId id) {
  const auto is_meant = [id](const ActiveScan& one) { return one.id == id; };
  if (scan && scan->id == id) return &*scan;
  if (const auto found = std::find_if(aside.begin(), aside.end(), is_meant); found != aside.end()) return &*found;
  if (const auto found = std::find_if(queue.begin(), queue.end(), is_meant); found != queue.end()) return &*found;
  return nullptr;
}

bool Sequencer::Impl::is_aside(const ActiveScan& one) const {
  return std::any_of(aside.begin(), aside.end(), [&](const ActiveScan& other) { return &other == &one; });
}

ActiveScan* Sequencer::Impl::addressed(const Command& c, ScanId id, ScanAsk ask) {
  ActiveScan* found = find_scan(id);
  if (found != nullptr) {
    if (takes(found->state, is_aside(*found), ask)) return found;
    reply(c.id, failure(not_now(id, found->state, is_aside(*found), ask)));
    return nullptr;
  }
  const auto over = std::find_if(ended.begin(), ended.end(), [id](const auto& one) { return one.first == id; });
  if (over != ended.end()) {
    reply(c.id, failure(not_now(id, over->second, false, ask)));
    return nullptr;
  }
  reply(c.id, failure(Error{.code = ErrorCode::NotFound,
                            .device = "sequencer",
                            .tried = fmt::format("{} scan {}", scan_ask_name(ask), id),
                            .seen = "no scan of this number is under way",
                            .limit = {}}));
  return nullptr;
}

void Sequencer::Impl::note_end(ScanId id, ScanState state) {
  constexpr std::size_t kRemembered = 100;
  ended.emplace_back(id, state);
  if (ended.size() > kRemembered) ended.pop_front();
}

}  // namespace gonio::daemon
