#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <utility>

#include "daemon/sequencer/failure_policy.h"
#include "daemon/sequencer/scan_events.h"
#include "daemon/sequencer/sequencer_impl.h"

namespace gonio::daemon {

namespace {

// Between two looks at a stage that still moves, or at a gate that is still open, when nothing of ours is under way.
constexpr Duration kLookAgain = std::chrono::milliseconds(50);

}  // namespace

void Sequencer::Impl::advance(Instant now) {
  while (!is_in_transition && !load_call && !waiting.empty()) {
    const Command command = std::move(waiting.front());
    waiting.pop_front();
    run(command, now);
  }
  if (load_call || store_error) return;
  if (scan && !is_in_transition) end_gone_holds(now);
  if (scan && !is_in_transition && scan->state == ScanState::Holding) set_aside(now);
  if (!scan && !is_in_transition) activate_next(now);
  if (!is_in_transition) start_by_hand();
  if (is_in_transition) return;
  if (!scan) {
    if (!shutters_to_close || !channels_are_free()) return;
    shutters_to_close = false;
    return ask_stage(StageUse::Shut,
                     MoveTo{.epoch = epoch, .source_shutter_open = false, .detector_shutter_open = false});
  }
  if (scan->is_found) return advance_found(now);
  switch (scan->state) {
    case ScanState::Queued:
      return transition(ScanEvent::Start, now, kDaemon, "its turn");
    case ScanState::Preparing:
      return advance_preparing(now);
    case ScanState::Running:
    case ScanState::Finishing:
      return advance_measuring(now);
    default:
      return;  // holding waits for a command
  }
}

// ---- after a restart ----

void Sequencer::Impl::advance_found(Instant now) {
  if (scan->state != ScanState::Interrupted) {
    return transition(ScanEvent::Found, now, kDaemon, "the daemon ended before the scan did");
  }
  scan->is_found = false;
  hold_for_disk(now);
  decide_after_restart(now);
}

void Sequencer::Impl::decide_after_restart(Instant now) {
  if (scan->has_hold(HoldName::Preempted)) {
    return end_holds(*scan, {HoldName::Preempted}, kDaemon, "the scan that ran first is over", now, std::nullopt);
  }
  if (!resumed_by.empty()) {
    const std::string who = std::exchange(resumed_by, {});
    const NewEvent cleared = event_holds_cleared(scan->id, std::exchange(scan->holds, {}), who);
    return transition(ScanEvent::Resume, now, who, "resumed after the store failed", std::nullopt,
                      {ClearHolds{.scan = scan->id, .who = who}}, {cleared});
  }
  if (scan->holds.empty() && scan->policy.on_restart == api::OnRestart::Hold) {
    add_hold(HoldName::Restart, kDaemon, "the plan asks to hold after a restart", now);
  }
  if (!scan->holds.empty()) return transition(ScanEvent::Hold, now, kDaemon, "on hold at the restart");
  transition(ScanEvent::Resume, now, kDaemon, "the plan asks to resume after a restart");
}

// ---- transitions and holds ----

void Sequencer::Impl::transition(ScanEvent event, Instant now, const std::string& who, const std::string& reason,
                                 std::optional<CommandId> command, std::vector<StoreWrite> more,
                                 std::vector<NewEvent> more_events) {
  const auto to = next_state(scan->state, event);
  assert(to && "the caller has asked the table");
  const bool finish_asked = scan->finish_asked || event == ScanEvent::Finish;
  const ScanTransition step{
      .scan = scan->id, .from = scan->state, .to = *to, .finish_asked = finish_asked, .who = who, .reason = reason};
  more.emplace_back(step);
  more_events.push_back(is_over(*to) ? event_over(step, progress()) : event_transition(step));
  is_in_transition = true;
  commit({.at = now, .writes = std::move(more), .events = std::move(more_events)},
         {.done =
              [this, state = *to, finish_asked, command](const CommitReceipt&, Instant then) {
                is_in_transition = false;
                count_state(scan->state, then);
                scan->state = state;
                scan->finish_asked = finish_asked;
                if (command) reply(*command, CommandDone{.scan = scan->id});
                entered(state, then);
              },
          .reply_failure_to = command});
}

// What passed in a state, but for jobs, which count for themselves.
void Sequencer::Impl::count_state(ScanState state, Instant now) {
  IdleTime& between = scan->between;
  const bool holds = state == ScanState::Holding;
  scan->ledger.enter(holds ? between.hold : state == ScanState::Preparing ? between.device : between.planning, now);
}

void Sequencer::Impl::entered(ScanState state, Instant now) {
  if (state == ScanState::Preparing) {
    scan->preparation = ActiveScan::Preparation::Detector;
    scan->reset_tried = false;
    scan->prepared_since = now;
    scan->visit_failures = 0;
    scan->warm_up_since.reset();
    hold_for_disk(now);
  }
  if (is_over(state)) {
    if (scan->finish_command) {
      reply(scan->finish_command->id, failure(not_now(scan->id, state, false, ScanAsk::Finish)));
    }
    note_end(scan->id, state);
    shutters_to_close = state == ScanState::Aborted || state == ScanState::Failed;
    scan.reset();
  }
}

// ---- preparing: nothing mechanical is trusted ----

void Sequencer::Impl::advance_preparing(Instant now) {
  using Preparation = ActiveScan::Preparation;
  if (scan->holds.empty() && scan->instrument_hash != config.instrument.sha256) {
    add_hold(HoldName::Restart, kDaemon,
             fmt::format("the scan was accepted under instrument {}, this is {}", scan->instrument_hash,
                         config.instrument.sha256),
             now);
  }
  if (!scan->holds.empty()) return transition(ScanEvent::Hold, now, kDaemon, scan->holds.front().reason);
  if (!channels_are_free()) return;
  switch (scan->preparation) {
    case Preparation::Detector:
      return ask_detector(DetectorUse::Prepare, PrepareDetector{});
    case Preparation::Monitor:
      return ask_monitor(MonitorUse::Prepare, PrepareMonitor{});
    case Preparation::Look:
      return ask_stage(StageUse::Look, LookAtStage{});
    case Preparation::LookAgain:
      if (now >= scan->look_again_at) ask_stage(StageUse::Look, LookAtStage{});
      return;
    case Preparation::Reset:
      return ask_stage(StageUse::Reset, ResetStage{.epoch = epoch});
    case Preparation::Home:
      return ask_stage(StageUse::Home, gonio::daemon::Home{.epoch = epoch});
    case Preparation::Shut:
      return ask_stage(StageUse::Darken, MoveTo{.epoch = epoch, .detector_shutter_open = false});
    case Preparation::Zero:
      return ask_detector(DetectorUse::Zero, ZeroDetector{});
    case Preparation::Lamp:
      return ask_stage(StageUse::LightLamp,
                       MoveTo{.epoch = epoch, .source_shutter_open = true, .detector_shutter_open = false});
    case Preparation::WarmUp:
      return advance_warm_up(now);
    case Preparation::Verified:
      if (!lamp_is_warm(now)) {
        scan->preparation = config.instrument.lamp.before_shutter ? Preparation::WarmUp : Preparation::Lamp;
        scan->look_again_at = now;
        return advance_preparing(now);
      }
      lamp_was_warm = true;
      if (zero_is_due()) {
        scan->preparation = Preparation::Shut;
        return advance_preparing(now);
      }
      return transition(ScanEvent::Prepared, now, kDaemon, "devices verified");
  }
}

// Once a run, before its first dark: a zero between two darks would shift what lies between them.
bool Sequencer::Impl::zero_is_due() const {
  const auto& power = config.instrument.detector.power;
  return power && power->zero && !scan->is_zeroed && !scan->last_dark;
}

void Sequencer::Impl::on_look(const Result<drivers::StageState>& state, Instant now) {
  if (!scan) return;
  if (!state) return add_hold(hold_for(state.error().code), "stage", describe(state.error()), now);
  verify_stage(*state, now);
}

void Sequencer::Impl::on_prepared_step(const Result<drivers::StageState>& state, ActiveScan::Preparation next,
                                       Instant now) {
  if (!scan) return;
  if (!state) return add_hold(hold_for(state.error().code), "stage", describe(state.error()), now);
  if (next == ActiveScan::Preparation::Verified) scan->is_position_in_doubt = false;  // it was homed
  scan->preparation = next;
}

void Sequencer::Impl::verify_stage(const drivers::StageState& state, Instant now) {
  using Preparation = ActiveScan::Preparation;
  if (state.halted) {
    return add_hold(HoldName::Operator, "stage", "the stage is stopped: reset it, then resume", now);
  }
  if (state.interlock_open) return add_hold(HoldName::Door, "stage", "the interlock is open", now);
  if (const auto out = watch.lamp_is_out()) {
    return add_hold(HoldName::Lamp, "stage", *out + ": the lamp, or its monitor, has failed", now);
  }
  epoch = std::max(epoch, state.epoch);  // of an earlier daemon's STOP, since reset
  stage_stopped = false;
  if (state.heartbeat_tripped || state.fault != 0) {
    if (!scan->reset_tried) {
      scan->reset_tried = true;
      scan->preparation = Preparation::Reset;
      return;
    }
    return add_hold(HoldName::Device, "stage",
                    fmt::format("a reset did not clear it: fault word {}, heartbeat {}", state.fault,
                                state.heartbeat_tripped ? "tripped" : "kept"),
                    now);
  }
  // A daemon that was killed leaves its last move and its last exposure behind.
  if (state.moving) return look_again(config.instrument.stage.homing_time, "the stage still moves", now);
  if (state.gate.open) {
    return look_again(config.instrument.detector.longest_exposure, "an exposure does not end", now);
  }
  scan->preparation = state.homed && !scan->is_position_in_doubt ? Preparation::Verified : Preparation::Home;
}

void Sequencer::Impl::look_again(Duration patience, const std::string& what, Instant now) {
  constexpr Duration kMargin = std::chrono::seconds(2);
  const Duration limit = patience + kMargin;
  if (now - scan->prepared_since > limit) {
    return add_hold(HoldName::Device, "stage", fmt::format("{} after {:.1f} s", what, in_seconds(limit)), now);
  }
  scan->preparation = ActiveScan::Preparation::LookAgain;
  scan->look_again_at = now + kLookAgain;
}

// ---- running and finishing ----

// What came to hold it meanwhile comes first, and the finish after it.
void Sequencer::Impl::begin_finish(Instant now) {
  drop_job(now);
  const Command command = *std::exchange(scan->finish_command, std::nullopt);
  const AuditEntry entry = audit(command, ScanAsk::Finish, scan->id, "");
  if (scan->holds.empty()) {
    return transition(ScanEvent::Finish, now, command.who, "asked to finish", command.id, {entry});
  }
  scan->finish_asked = true;
  transition(ScanEvent::Hold, now, kDaemon, scan->holds.front().reason, command.id, {entry});
}

void Sequencer::Impl::advance_measuring(Instant now) {
  // Between two frames an item is in hand as much as during them; one that only moves is given up without loss.
  const bool is_in_hand = scan->job && (scan->job->phase == Job::Phase::Exposing ||
                                        (scan->job->measurement && !scan->job->measurement->readings().empty()));
  if (!is_in_hand && scan->finish_command && scan->state == ScanState::Running) return begin_finish(now);
  if (!is_in_hand && !scan->holds.empty()) {
    drop_job(now);
    return transition(ScanEvent::Hold, now, kDaemon, scan->holds.front().reason);
  }
  if (!is_in_hand && makes_way(now)) return advance_measuring(now);
  constexpr int kStepsAtOnce = 2;  // a few microseconds
  scan->way.look_on(config.instrument, scan->points, scan->items.order(), kStepsAtOnce);
  if (!scan->job) choose_job(now);
  if (scan->job && !is_in_transition) drive_job(now);
}

}  // namespace gonio::daemon
