#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "daemon/planner/planner.h"
#include "daemon/sequencer/scan_events.h"
#include "daemon/sequencer/sequencer_impl.h"

namespace gonio::daemon {

namespace {

constexpr std::size_t kMostWaiting = 64;
constexpr std::size_t kMostQueued = 1000;

std::string by_hand_name(const Verb& verb) {
  if (std::holds_alternative<MoveStage>(verb)) return "stage move";
  if (std::holds_alternative<ReadDetector>(verb)) return "detector read";
  return std::holds_alternative<HomeStage>(verb) ? "stage home" : "stage reset";
}

}  // namespace

Error Sequencer::Impl::busy(const std::string& tried, const std::string& seen) {
  return Error{.code = ErrorCode::Busy, .device = "sequencer", .tried = tried, .seen = seen};
}

AuditEntry Sequencer::Impl::audit(const Command& c, ScanAsk ask, ScanId scan, const std::string& detail) {
  return {.who = c.who,
          .action = std::string(scan_ask_name(ask)),
          .detail = fmt::format("scan {}{}{}", scan, detail.empty() ? "" : ": ", detail)};
}

void Sequencer::Impl::run(const Command& command, Instant now) {
  const bool is_resume = std::holds_alternative<ResumeScan>(command.verb);
  if (store_error && !is_resume) {
    // With no scan to resume, whoever wants something has the store read again.
    if (scan || load_call || !commits.empty()) return reply(command.id, failure(*store_error));
    load_from_store();
  }
  if (is_in_transition || load_call) {
    if (waiting.size() >= kMostWaiting) return reply(command.id, failure(busy("take a command", "64 wait already")));
    waiting.push_back(command);
    return;
  }
  std::visit([&](const auto& verb) { run_verb(command, verb, now); }, command.verb);
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
                        .merged = submit.scan.planned.merged,
                        .turn = submit.scan.turn,
                        .predicted = prediction_of(submit.scan.planned)};
  const AuditEntry entry{.who = c.who, .action = "submit", .detail = submit.scan.name};
  commit({.at = now, .writes = {submit.scan, entry}, .events = {event_submitted(submit.scan)}},
         {.done =
              [this, id = c.id, stored = std::move(stored)](const CommitReceipt& receipt, Instant) mutable {
                reply(id, CommandDone{.scan = receipt.new_scan, .existed = receipt.existed});
                if (receipt.existed) return;
                stored.id = receipt.new_scan;
                queue.emplace_back(std::move(stored), config.instrument);
              },
          .reply_failure_to = c.id});
}

void Sequencer::Impl::run_verb(const Command& c, const FinishScan& finish, Instant now) {
  ActiveScan* ending = addressed(c, finish.scan, ScanAsk::Finish);
  if (ending == nullptr || refuse_while_stopped(c)) return;
  if (scan->finish_command) {
    return reply(c.id, failure(not_now(scan->id, scan->state, false, ScanAsk::Finish,
                                       scan->finish_command->who + " has asked for that already")));
  }
  if (scan->state == ScanState::Running) {
    // After the item in hand: advance() sees it. A pause that waits for the same moment gives way.
    if (scan->has_hold(HoldName::Operator)) {
      end_holds(*scan, {HoldName::Operator}, c.who, "asked to finish", now, std::nullopt);
    }
    scan->finish_command = c;
    return;
  }
  const NewEvent cleared = event_holds_cleared(scan->id, std::exchange(scan->holds, {}), c.who);
  disown_calls();
  transition(ScanEvent::Finish, now, c.who, "asked to finish", c.id,
             {ClearHolds{.scan = scan->id, .who = c.who}, audit(c, ScanAsk::Finish, scan->id, "")}, {cleared});
}

void Sequencer::Impl::run_verb(const Command& c, const AbortScan& abort, Instant now) {
  const std::string reason = abort.reason.empty() ? "aborted" : abort.reason;
  const ActiveScan* ending = addressed(c, abort.scan, ScanAsk::Abort);
  if (ending == nullptr) return;
  if (!is_active(*ending)) return abort_waiting(c, *ending, reason, now);
  drop_job(now);
  disown_calls();
  transition(ScanEvent::Abort, now, c.who, reason, c.id, {audit(c, ScanAsk::Abort, scan->id, reason)});
}

void Sequencer::Impl::abort_waiting(const Command& c, const ActiveScan& waits, const std::string& reason, Instant now) {
  const ScanId id = waits.id;
  const ScanTransition step{.scan = id, .from = waits.state, .to = ScanState::Aborted, .who = c.who, .reason = reason};
  std::erase_if(queue, [id](const ActiveScan& q) { return q.id == id; });
  std::erase_if(aside, [id](const ActiveScan& q) { return q.id == id; });
  note_end(id, ScanState::Aborted);
  commit(
      {.at = now, .writes = {step, audit(c, ScanAsk::Abort, id, reason)}, .events = {event_transition(step)}},
      {.done = [this, command = c.id, id](const CommitReceipt&, Instant) { reply(command, CommandDone{.scan = id}); },
       .reply_failure_to = c.id});
}

void Sequencer::Impl::run_verb(const Command& c, const SkipItemInHand& skip, Instant now) {
  if (addressed(c, skip.scan, ScanAsk::Skip) == nullptr) return;
  std::optional<ItemKey> item;
  if (scan->job && scan->job->kind == Job::Kind::Item) item = scan->job->item;
  // While it waits, the next one is what it waits before: one that fails again and again can be left out.
  if (scan->state != ScanState::Running) item = scan->items.next(now);
  if (!item) {
    return reply(c.id, failure(not_now(scan->id, scan->state, false, ScanAsk::Skip,
                                       fmt::format("no item is in hand, it is {}", doing()))));
  }
  drop_job(now);
  StoreTransaction transaction{.at = now};
  for (const ItemKey& gone : scan->items.give_up(*item)) {
    const SkipItem record{.scan = scan->id, .item = gone, .who = c.who, .reason = "skipped by hand"};
    transaction.writes.emplace_back(record);
    transaction.events.push_back(event_skipped(record));
  }
  const std::string what = fmt::format("point {} ({})", item->point, target_name(item->target));
  transaction.writes.emplace_back(audit(c, ScanAsk::Skip, scan->id, what));
  commit(std::move(transaction), {.done =
                                      [this, id = c.id, scan_id = scan->id, what](const CommitReceipt&, Instant) {
                                        reply(id, CommandDone{.scan = scan_id, .note = what + " is skipped"});
                                      },
                                  .reply_failure_to = c.id});
}

// ---- the stage by hand ----

void Sequencer::Impl::run_verb(const Command& c, const MoveStage&, Instant now) {
  take_by_hand(c, now);
}
void Sequencer::Impl::run_verb(const Command& c, const HomeStage&, Instant now) {
  take_by_hand(c, now);
}
void Sequencer::Impl::run_verb(const Command& c, const ClearStage&, Instant now) {
  take_by_hand(c, now);
}

void Sequencer::Impl::take_by_hand(const Command& c, Instant now) {
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
  const AuditEntry entry{.who = c.who, .action = by_hand_name(c.verb), .detail = ""};
  commit({.at = now, .writes = {entry}, .events = {}}, {.done = [](const CommitReceipt&, Instant) {}});
  by_hand = c;
  by_hand_is_asked = false;
  by_hand_has_reset = false;
}

void Sequencer::Impl::start_by_hand() {
  if (!by_hand || by_hand_is_asked) return;
  if (scan && scan->state != ScanState::Holding) {
    return end_by_hand(failure(Error{.code = ErrorCode::WrongState,
                                     .device = "stage",
                                     .tried = by_hand_name(by_hand->verb),
                                     .seen = fmt::format("scan {} went on meanwhile", scan->id),
                                     .limit = "allowed while no scan is under way, or while it holds"}));
  }
  if (!channels_are_free()) return;
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
