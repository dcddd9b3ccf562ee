#include <algorithm>
#include <utility>

#include "daemon/planner/planner.h"
#include "daemon/sequencer/scan_events.h"
#include "daemon/sequencer/sequencer_impl.h"

namespace gonio::daemon {

namespace {

constexpr std::size_t kMostWaiting = 64;
constexpr std::size_t kMostQueued = 1000;

Error busy(const std::string& tried, const std::string& seen) {
  return Error{.code = ErrorCode::Busy, .device = "sequencer", .tried = tried, .seen = seen};
}

}  // namespace

void Sequencer::Impl::run(const Command& command, Instant now) {
  const bool is_resume = std::holds_alternative<ResumeScan>(command.verb);
  if (store_error && !is_resume) return reply(command.id, failure(*store_error));
  if (is_in_transition || load_call) {
    if (waiting.size() >= kMostWaiting) return reply(command.id, failure(busy("take a command", "64 wait already")));
    waiting.push_back(command);
    return;
  }
  std::visit([&](const auto& verb) { run_verb(command, verb, now); }, command.verb);
}

// True when the command concerns the active scan; else it is answered here.
bool Sequencer::Impl::is_active(const Command& c, ScanId id) {
  if (scan && scan->id == id) return true;
  const bool is_queued = std::any_of(queue.begin(), queue.end(), [id](const ActiveScan& q) { return q.id == id; });
  reply(c.id, failure(Error{.code = is_queued ? ErrorCode::WrongState : ErrorCode::NotFound,
                            .device = "sequencer",
                            .tried = "command scan " + std::to_string(id),
                            .seen = is_queued ? "it is queued" : "no scan of this number is under way",
                            .limit = is_queued ? "only abort is allowed while queued" : ""}));
  return false;
}

bool Sequencer::Impl::refuse_while_stopped(const Command& c) {
  if (!stage_stopped) return false;
  reply(c.id, failure(Error{.code = ErrorCode::WrongState,
                            .device = "stage",
                            .tried = "go on with scan " + std::to_string(scan->id),
                            .seen = "the stage is stopped",
                            .limit = "reset the stage first"}));
  return true;
}

void Sequencer::Impl::run_verb(const Command& c, const SubmitScan& submit, Instant now) {
  if (queue.size() >= kMostQueued) return reply(c.id, failure(busy("queue a scan", "1000 scans are queued")));
  UnfinishedScan stored{.state = ScanState::Queued,
                        .name = submit.scan.name,
                        .policy = submit.scan.policy,
                        .isotropic = submit.scan.isotropic,
                        .instrument_hash = submit.scan.instrument_hash,
                        .points = submit.scan.planned.points,
                        .order = submit.scan.planned.order,
                        .merged = submit.scan.planned.merged};
  commit({.at = now, .writes = {submit.scan}, .events = {event_submitted(submit.scan)}},
         {.done =
              [this, id = c.id, stored = std::move(stored)](const CommitReceipt& receipt, Instant) mutable {
                reply(id, CommandDone{.scan = receipt.new_scan, .existed = receipt.existed});
                if (receipt.existed) return;
                stored.id = receipt.new_scan;
                queue.emplace_back(std::move(stored), config.instrument);
              },
          .reply_failure_to = c.id});
}

void Sequencer::Impl::run_verb(const Command& c, const PauseScan& pause, Instant now) {
  if (!is_active(c, pause.scan)) return;
  const bool can_hold = scan->state == ScanState::Holding || next_state(scan->state, ScanEvent::Hold);
  if (!can_hold) return reply(c.id, failure(wrong_state(scan->id, scan->state, ScanEvent::Hold)));
  if (pause.now) drop_job(now);
  add_hold(HoldName::Operator, c.who, pause.reason.empty() ? "paused" : pause.reason, now, c.id);
}

void Sequencer::Impl::run_verb(const Command& c, const ResumeScan& resume, Instant now) {
  if (!is_active(c, resume.scan)) return;
  if (store_error) {
    if (!commits.empty() || load_call) return reply(c.id, failure(busy("resume", "the store has not answered yet")));
    resumed_by = c.who;
    resume_command = c.id;
    return load_from_store();
  }
  if (refuse_while_stopped(c)) return;
  const bool waits_for_its_item = scan->state == ScanState::Running && !scan->holds.empty();
  if (scan->state != ScanState::Holding && !waits_for_its_item) {
    return reply(c.id, failure(wrong_state(scan->id, scan->state, ScanEvent::Resume)));
  }
  const ClearHolds clear{.scan = scan->id, .who = c.who};
  const NewEvent cleared = event_holds_cleared(scan->id, std::exchange(scan->holds, {}), c.who);
  if (scan->state == ScanState::Holding) {
    return transition(ScanEvent::Resume, now, c.who, "resumed", c.id, {clear}, {cleared});
  }
  commit({.at = now, .writes = {clear}, .events = {cleared}},
         {.done = [this, id = c.id, scan_id = scan->id](const CommitReceipt&,
                                                        Instant) { reply(id, CommandDone{.scan = scan_id}); },
          .reply_failure_to = c.id});
}

void Sequencer::Impl::run_verb(const Command& c, const FinishScan& finish, Instant now) {
  if (!is_active(c, finish.scan)) return;
  if (!next_state(scan->state, ScanEvent::Finish) || scan->finish_command) {
    return reply(c.id, failure(wrong_state(scan->id, scan->state, ScanEvent::Finish)));
  }
  if (refuse_while_stopped(c)) return;
  if (scan->state == ScanState::Running) {
    scan->finish_command = c;  // after the item in hand: advance() sees it
    return;
  }
  const NewEvent cleared = event_holds_cleared(scan->id, std::exchange(scan->holds, {}), c.who);
  disown_calls();
  transition(ScanEvent::Finish, now, c.who, "asked to finish", c.id, {ClearHolds{.scan = scan->id, .who = c.who}},
             {cleared});
}

void Sequencer::Impl::run_verb(const Command& c, const AbortScan& abort, Instant now) {
  const std::string reason = abort.reason.empty() ? "aborted" : abort.reason;
  const bool is_queued =
      std::any_of(queue.begin(), queue.end(), [&](const ActiveScan& q) { return q.id == abort.scan; });
  if (is_queued) return abort_queued(c, abort.scan, reason, now);
  if (!is_active(c, abort.scan)) return;
  drop_job(now);
  disown_calls();
  transition(ScanEvent::Abort, now, c.who, reason, c.id);
}

void Sequencer::Impl::abort_queued(const Command& c, ScanId id, const std::string& reason, Instant now) {
  const ScanTransition step{
      .scan = id, .from = ScanState::Queued, .to = ScanState::Aborted, .who = c.who, .reason = reason};
  std::erase_if(queue, [id](const ActiveScan& q) { return q.id == id; });
  commit(
      {.at = now, .writes = {step}, .events = {event_transition(step)}},
      {.done = [this, command = c.id, id](const CommitReceipt&, Instant) { reply(command, CommandDone{.scan = id}); },
       .reply_failure_to = c.id});
}

void Sequencer::Impl::run_verb(const Command& c, const SkipItemInHand& skip, Instant now) {
  if (!is_active(c, skip.scan)) return;
  if (!scan->job || scan->job->kind != Job::Kind::Item) {
    return reply(c.id, failure(Error{.code = ErrorCode::WrongState,
                                     .device = "sequencer",
                                     .tried = "skip the item in hand",
                                     .seen = "there is none"}));
  }
  const ItemKey item = scan->job->item;
  drop_job(now);
  StoreTransaction transaction{.at = now};
  for (const ItemKey& gone : scan->items.give_up(item)) {
    const SkipItem record{.scan = scan->id, .item = gone, .who = c.who, .reason = "skipped by hand"};
    transaction.writes.emplace_back(record);
    transaction.events.push_back(event_skipped(record));
  }
  commit(std::move(transaction),
         {.done = [this, id = c.id, scan_id = scan->id](const CommitReceipt&,
                                                        Instant) { reply(id, CommandDone{.scan = scan_id}); },
          .reply_failure_to = c.id});
}

// ---- the stage by hand ----

void Sequencer::Impl::run_verb(const Command& c, const MoveStage&, Instant) {
  take_by_hand(c);
}
void Sequencer::Impl::run_verb(const Command& c, const HomeStage&, Instant) {
  take_by_hand(c);
}
void Sequencer::Impl::run_verb(const Command& c, const ClearStage&, Instant) {
  take_by_hand(c);
}

void Sequencer::Impl::take_by_hand(const Command& c) {
  const bool is_reading = std::holds_alternative<ReadDetector>(c.verb);
  const std::string tried = is_reading ? "read the detector by hand" : "move the stage by hand";
  if (by_hand) return reply(c.id, failure(busy(tried, "another such command is in work")));
  if (scan && scan->state != ScanState::Holding) {
    return reply(c.id, failure(Error{.code = ErrorCode::WrongState,
                                     .device = is_reading ? "detector" : "stage",
                                     .tried = tried,
                                     .seen = "scan " + std::to_string(scan->id) + " is " +
                                             std::string(scan_state_name(scan->state)),
                                     .limit = "allowed while no scan is under way, or while it holds"}));
  }
  by_hand = c;
  by_hand_is_asked = false;
  by_hand_has_reset = false;
}

void Sequencer::Impl::start_by_hand() {
  if (!by_hand || by_hand_is_asked || !channels_are_free()) return;
  by_hand_is_asked = true;
  ask_stage(StageUse::HandLook, LookAtStage{});
}

void Sequencer::Impl::end_by_hand(Result<CommandDone> result) {
  reply(by_hand->id, std::move(result));
  by_hand.reset();
}

void Sequencer::Impl::on_hand_look(const Result<drivers::StageState>& state) {
  if (!state) return end_by_hand(failure(state.error()));
  epoch = std::max(epoch, state->epoch);  // of an earlier daemon; while the stage is halted it refuses all the same
  if (std::holds_alternative<ClearStage>(by_hand->verb))
    return ask_stage(StageUse::HandDone, ResetStage{.epoch = epoch});
  // An earlier daemon's end trips the heartbeat: the next controller clears it. A STOP it never clears.
  if (state->heartbeat_tripped && !state->halted && !by_hand_has_reset) {
    by_hand_has_reset = true;
    return ask_stage(StageUse::HandLook, ResetStage{.epoch = epoch});
  }
  if (std::holds_alternative<HomeStage>(by_hand->verb)) {
    return ask_stage(StageUse::HandDone, gonio::daemon::Home{.epoch = epoch});
  }
  if (std::holds_alternative<ReadDetector>(by_hand->verb)) return begin_hand_reading(*state);
  const auto& move = std::get<MoveStage>(by_hand->verb);
  const auto allowed = check_move(move.target, positions_of(*state), config.instrument);
  if (!allowed) return end_by_hand(failure(allowed.error()));
  ask_stage(StageUse::HandDone, MoveTo{.epoch = epoch,
                                       .target = move.target,
                                       .source_shutter_open = move.source_shutter_open,
                                       .detector_shutter_open = move.detector_shutter_open});
}

void Sequencer::Impl::on_hand_done(const Result<drivers::StageState>& state) {
  if (!state) return end_by_hand(failure(state.error()));
  if (std::holds_alternative<ClearStage>(by_hand->verb)) stage_stopped = state->halted;
  end_by_hand(CommandDone{});
}

}  // namespace gonio::daemon
