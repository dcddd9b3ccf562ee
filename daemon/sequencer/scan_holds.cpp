// Why a scan waits, and what ends it: holds of the active scan and of those that wait.
#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "daemon/sequencer/scan_events.h"
#include "daemon/sequencer/sequencer_impl.h"

namespace gonio::daemon {

namespace {

// Ended by themselves without an item measured in between: somebody has to look.
constexpr int kMostEndsByThemselves = 10;

std::string listed(const std::vector<Hold>& holds) {
  std::string text;
  for (const Hold& hold : holds) {
    text += fmt::format("{}{} ({}: {})", text.empty() ? "" : ", ", hold_name(hold.name), hold.owner, hold.reason);
  }
  return text;
}

}  // namespace

// Held for that already: nothing changes, and who asked is recorded all the same.
void Sequencer::Impl::note_again(const ActiveScan& held, const Command& command, Instant now) {
  const CommandDone done{.scan = held.id, .note = "it holds already: " + listed(held.holds)};
  commit({.at = now, .writes = {audit(command, ScanAsk::Pause, held.id, "it held already")}, .events = {}},
         {.done = [this, id = command.id, done](const CommitReceipt&, Instant) { reply(id, done); },
          .reply_failure_to = command.id});
}

// Waiting needs no permission: the hold acts at once, and is written as soon as the store takes it.
void Sequencer::Impl::hold_scan(ActiveScan& held, Hold hold, Instant now, const std::optional<Command>& command) {
  if (held.has_hold(hold.name)) {
    if (command) note_again(held, *command, now);
    return;
  }
  if (hold.name == HoldName::Lamp) {
    lamp.forget();
    lamp_was_warm = false;
  }
  hold.since = now;
  held.holds.push_back(hold);
  StoreTransaction transaction{
      .at = now, .writes = {AddHold{.scan = held.id, .hold = hold}}, .events = {event_hold_added(held.id, hold)}};
  if (command) transaction.writes.emplace_back(audit(*command, ScanAsk::Pause, held.id, hold.reason));
  const std::optional<CommandId> id = command ? std::optional(command->id) : std::nullopt;
  commit(std::move(transaction), {.done =
                                      [this, scan_id = held.id, id](const CommitReceipt&, Instant) {
                                        if (id) reply(*id, CommandDone{.scan = scan_id});
                                      },
                                  .reply_failure_to = id});
}

void Sequencer::Impl::add_hold(HoldName name, const std::string& owner, const std::string& reason, Instant now) {
  hold_scan(*scan, Hold{.name = name, .owner = owner, .reason = reason}, now, std::nullopt);
}

void Sequencer::Impl::run_verb(const Command& c, const PauseScan& pause, Instant now) {
  ActiveScan* held = addressed(c, pause.scan, pause.now ? ScanAsk::PauseNow : ScanAsk::Pause);
  if (held == nullptr) return;
  if (pause.now && is_active(*held)) drop_job(now);
  const std::string reason = pause.reason.empty() ? "paused" : pause.reason;
  hold_scan(*held, Hold{.name = HoldName::Operator, .owner = c.who, .reason = reason}, now, c);
}

// ---- the end of holds ----

void Sequencer::Impl::run_verb(const Command& c, const ResumeScan& resume, Instant now) {
  if (store_error && (!scan || scan->id == resume.scan)) {
    if (!commits.empty() || load_call) return reply(c.id, failure(busy("resume", "the store has not answered yet")));
    resumed_by = c.who;
    resume_command = c.id;
    return load_from_store();
  }
  ActiveScan* held = addressed(c, resume.scan, ScanAsk::Resume);
  if (held == nullptr) return;
  if (is_active(*held) && refuse_while_stopped(c)) return;
  // What was seen of door and lamp may be a second old: whoever has just closed the door is right.
  const bool is_seen = held->has_hold(HoldName::Door) || held->has_hold(HoldName::Lamp);
  if (is_active(*held) && held->state == ScanState::Holding && is_seen && !resume_waits && !by_hand &&
      channels_are_free()) {
    resume_waits = c;
    return ask_stage(StageUse::ResumeLook, LookAtStage{});
  }
  decide_resume(c, *held, resume.hold, now);
}

void Sequencer::Impl::on_resume_look(Instant now) {
  const Command c = *std::exchange(resume_waits, std::nullopt);
  const auto& resume = std::get<ResumeScan>(c.verb);
  if (is_in_transition || load_call || store_error) return run(c, now);
  ActiveScan* held = addressed(c, resume.scan, ScanAsk::Resume);
  if (held == nullptr || (is_active(*held) && refuse_while_stopped(c))) return;
  decide_resume(c, *held, resume.hold, now);
}

void Sequencer::Impl::decide_resume(const Command& c, ActiveScan& held, std::optional<HoldName> wanted, Instant now) {
  const auto refuse = [&](const std::string& why) {
    reply(c.id, failure(not_now(held.id, held.state, is_aside(held), ScanAsk::Resume, why)));
  };
  if (held.holds.empty() && held.state != ScanState::Interrupted) return refuse("nothing holds it");
  if (wanted && !held.has_hold(*wanted)) {
    return refuse(fmt::format("it has no hold {}; it has: {}", hold_name(*wanted), listed(held.holds)));
  }
  std::vector<HoldName> gone;
  std::string standing;
  for (const Hold& hold : held.holds) {
    if (wanted && hold.name != *wanted) continue;
    auto why = hold.name == HoldName::Preempted
                   ? std::optional<std::string>(hold.reason + "; it goes on by itself when that is over")
                   : watch.standing(hold.name);
    if (!why) {
      gone.push_back(hold.name);
    } else {
      standing += fmt::format("{}{}: {}", standing.empty() ? "" : "; ", hold_name(hold.name), *why);
    }
  }
  if (gone.empty() && !held.holds.empty()) return refuse(standing);
  held.ends_by_themselves = 0;
  end_holds(held, gone, c.who, "resumed", now, c);
}

void Sequencer::Impl::end_holds(ActiveScan& held, const std::vector<HoldName>& names, const std::string& who,
                                const std::string& reason, Instant now, const std::optional<Command>& command) {
  const auto is_named = [&](const Hold& hold) {
    return std::find(names.begin(), names.end(), hold.name) != names.end();
  };
  std::vector<Hold> cleared;
  std::copy_if(held.holds.begin(), held.holds.end(), std::back_inserter(cleared), is_named);
  std::erase_if(held.holds, is_named);
  StoreTransaction transaction{.at = now};
  if (!cleared.empty()) {
    transaction.writes.emplace_back(ClearHolds{.scan = held.id, .who = who, .names = names});
    transaction.events.push_back(event_holds_cleared(held.id, cleared, who));
  }
  if (command) transaction.writes.emplace_back(audit(*command, ScanAsk::Resume, held.id, listed(cleared)));
  const std::optional<CommandId> id = command ? std::optional(command->id) : std::nullopt;
  const bool waits = held.state == ScanState::Holding || held.state == ScanState::Interrupted;
  if (is_active(held) && waits && held.holds.empty()) {
    held.is_found = false;
    return transition(ScanEvent::Resume, now, who, reason, id, std::move(transaction.writes),
                      std::move(transaction.events));
  }
  const std::string note = held.holds.empty() ? std::string() : "still held: " + listed(held.holds);
  commit(std::move(transaction), {.done =
                                      [this, scan_id = held.id, id, note](const CommitReceipt&, Instant) {
                                        if (id) reply(*id, CommandDone{.scan = scan_id, .note = note});
                                      },
                                  .reply_failure_to = id});
}

// Where the instrument's file says so, a hold whose cause has been gone for long enough ends; where the plan says so,
// one of a stage that had lost power and is back. A bounded number of times.
void Sequencer::Impl::end_gone_holds(Instant now) {
  if (stage_stopped || scan->holds.empty()) return;
  std::vector<HoldName> gone;
  for (const Hold& hold : scan->holds) {
    const bool lost_power = scan->policy.on_restart == api::OnRestart::Resume && watch.ends_after_boot(hold, now);
    if (lost_power || watch.ends_by_itself(hold, now)) gone.push_back(hold.name);
  }
  if (gone.empty()) return;
  if (scan->items.accepted() > scan->accepted_at_end) scan->ends_by_themselves = 0;
  if (scan->ends_by_themselves >= kMostEndsByThemselves) return;
  ++scan->ends_by_themselves;
  scan->accepted_at_end = scan->items.accepted();
  end_holds(*scan, gone, kDaemon, "the cause has gone", now, std::nullopt);
}

// ---- what is seen of their causes ----

void Sequencer::Impl::see_stage(const drivers::StageState& state, Instant now) {
  watch.see_stage(state, now);
  const bool is_in_light = config.instrument.lamp.before_shutter || state.source_shutter == stage::ShutterState::Open;
  if (!config.instrument.monitor && is_in_light) see_lamp(state.monitor, now);
  const bool measures = scan && (scan->state == ScanState::Running || scan->state == ScanState::Finishing);
  if (!state.interlock_open || !measures || is_in_transition || scan->has_hold(HoldName::Door)) return;
  drop_job(now);
  add_hold(HoldName::Door, "stage", "the interlock is open", now);
}

void Sequencer::Impl::see_lamp(double monitor, Instant now) {
  const LampBand& band = config.instrument.lamp;
  // A radiometer is asked during exposures only: what it said says nothing of a lamp that was seen to since.
  if (!config.instrument.monitor) watch.see_lamp(monitor, now);
  if (monitor < band.low || monitor > band.high) return lamp.forget();
  lamp.see(monitor, now);
  lamp_seen = now;
}

void Sequencer::Impl::on_message(const DiskSeen& disk, Instant now) {
  watch.see_disk(disk.free_bytes, now);
  hold_for_disk(now);
}

void Sequencer::Impl::hold_for_disk(Instant now) {
  const bool is_under_way = scan && (scan->state == ScanState::Preparing || scan->state == ScanState::Running ||
                                     scan->state == ScanState::Finishing);
  const auto why = watch.standing(HoldName::Disk);
  if (why && is_under_way && !store_error && !load_call) add_hold(HoldName::Disk, "store", *why, now);
}

}  // namespace gonio::daemon
