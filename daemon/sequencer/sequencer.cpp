#include "daemon/sequencer/sequencer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/sequencer/failure_policy.h"
#include "daemon/sequencer/scan_events.h"
#include "daemon/sequencer/sequencer_impl.h"

namespace gonio::daemon {

Sequencer::Sequencer(SequencerConfig config, Instant /*now*/) : impl_(std::make_unique<Impl>(std::move(config))) {
  impl_->load_from_store();
}
Sequencer::~Sequencer() = default;
Sequencer::Sequencer(Sequencer&&) noexcept = default;
Sequencer& Sequencer::operator=(Sequencer&&) noexcept = default;

void Sequencer::on(const SequencerMessage& message, Instant now) {
  std::visit([this, now](const auto& m) { impl_->on_message(m, now); }, message);
  impl_->advance(now);
}

std::optional<Instant> Sequencer::step(Instant now) {
  impl_->advance(now);
  return impl_->next_wake(now);
}

std::vector<Request> Sequencer::take_requests() {
  return std::exchange(impl_->requests, {});
}
std::vector<CommandReply> Sequencer::take_replies() {
  return std::exchange(impl_->replies, {});
}
SequencerStatus Sequencer::status(Instant now) const {
  return impl_->status(now);
}

// ---- channels ----

void Sequencer::Impl::ask_stage(StageUse use, StageRequest request) {
  stage_call = {++last_ticket, use};
  std::visit([this](auto& r) { r.ticket = last_ticket; }, request);
  requests.emplace_back(std::move(request));
}

void Sequencer::Impl::ask_detector(DetectorUse use, DetectorRequest request) {
  detector_call = {++last_ticket, use};
  std::visit([this](auto& r) { r.ticket = last_ticket; }, request);
  requests.emplace_back(std::move(request));
}

void Sequencer::Impl::ask_monitor(MonitorUse use, MonitorRequest request) {
  monitor_call = {++last_ticket, use};
  std::visit([this](auto& r) { r.ticket = last_ticket; }, request);
  requests.emplace_back(std::move(request));
}

void Sequencer::Impl::commit(StoreTransaction transaction, PendingCommit pending) {
  commits.emplace(++last_ticket, std::move(pending));
  requests.emplace_back(StoreRequest{Commit{.ticket = last_ticket, .transaction = std::move(transaction)}});
}

void Sequencer::Impl::load_from_store() {
  load_call = ++last_ticket;
  requests.emplace_back(StoreRequest{LoadUnfinished{.ticket = last_ticket}});
}

bool Sequencer::Impl::has_uncommitted_item() const {
  return std::any_of(commits.begin(), commits.end(), [](const auto& c) { return c.second.holds_exposures; });
}

void Sequencer::Impl::disown_calls() {
  // A command gets its answer, whatever becomes of the scan.
  if (stage_call && stage_call->use < StageUse::HandLook) stage_call->use = StageUse::Dropped;
  if (detector_call && detector_call->use < DetectorUse::HandPrepare) detector_call->use = DetectorUse::Dropped;
  if (monitor_call) monitor_call->use = MonitorUse::Dropped;
}

std::optional<Instant> Sequencer::Impl::next_wake(Instant now) const {
  std::optional<Instant> wake = next_start(now);
  using Preparation = ActiveScan::Preparation;
  const bool looks_again = scan && scan->state == ScanState::Preparing && !is_in_transition && channels_are_free() &&
                           (scan->preparation == Preparation::LookAgain || scan->preparation == Preparation::WarmUp);
  if (looks_again) wake = std::min(wake.value_or(scan->look_again_at), scan->look_again_at);
  return wake;
}

// ---- answers ----

void Sequencer::Impl::on_message(const Command& command, Instant now) {
  run(command, now);
}

void Sequencer::Impl::note_stage(const drivers::StageState& state) {
  stage = state;
  if (state.halted) stage_stopped = true;
}

void Sequencer::Impl::on_message(const StageAnswer& answer, Instant now) {
  if (answer.ticket == kWatchTicket) {
    if (answer.state) return see_stage(*answer.state, now);
    return watch.see_stage_failing(answer.state.error());
  }
  if (!stage_call || stage_call->ticket != answer.ticket) return;
  const StageUse use = stage_call->use;
  stage_call.reset();
  if (answer.state) note_stage(*answer.state);
  if (answer.state) see_stage(*answer.state, now);
  switch (use) {
    case StageUse::Look:
      return on_look(answer.state, now);
    case StageUse::Reset:
      return on_prepared_step(answer.state, ActiveScan::Preparation::Look, now);
    case StageUse::Home:
      return on_prepared_step(answer.state, ActiveScan::Preparation::Verified, now);
    case StageUse::Darken:
      return on_prepared_step(answer.state, ActiveScan::Preparation::Zero, now);
    case StageUse::LightLamp:
      return on_prepared_step(answer.state, ActiveScan::Preparation::WarmUp, now);
    case StageUse::LampLook:
      if (!answer.state) return on_prepared_step(answer.state, ActiveScan::Preparation::WarmUp, now);
      return on_lamp_seen(now);
    case StageUse::ResumeLook:
      return on_resume_look(now);
    case StageUse::Before:
      return on_before(answer.state, now);
    case StageUse::After:
      return on_after(answer.state, now);
    case StageUse::HomeAgain:
      return on_homed_again(answer.state, now);
    case StageUse::Move:
      return on_moved(answer.state, now);
    case StageUse::Gate:
      return on_gate(answer.state, now);
    case StageUse::HandLook:
      return on_hand_look(answer.state);
    case StageUse::HandDone:
      return on_hand_done(answer.state);
    case StageUse::HandShutters:
      return on_hand_shutters(answer.state);
    case StageUse::HandShuttersBack:
      return on_hand_shutters_back(answer.state);
    case StageUse::Dropped:
    case StageUse::Shut:
      return;
  }
}

void Sequencer::Impl::on_message(const FrameAnswer& answer, Instant now) {
  if (!detector_call || detector_call->ticket != answer.ticket) return;
  const DetectorUse use = detector_call->use;
  detector_call.reset();
  if (use == DetectorUse::Frame) on_frame(answer.frame, now);
  if (use == DetectorUse::HandFrame) on_hand_frame(answer.frame);
}

void Sequencer::Impl::on_message(const DetectorAnswer& answer, Instant now) {
  if (!detector_call || detector_call->ticket != answer.ticket) return;
  const DetectorUse use = detector_call->use;
  detector_call.reset();
  if (use == DetectorUse::HandPrepare) return on_hand_prepared(answer.detector);
  if (use == DetectorUse::Dropped || !scan) return;
  if (!answer.detector) {
    return add_hold(hold_for(answer.detector.error().code), "detector", describe(answer.detector.error()), now);
  }
  using Preparation = ActiveScan::Preparation;
  if (use == DetectorUse::Zero) scan->is_zeroed = true;
  if (use == DetectorUse::Zero) scan->preparation = Preparation::Verified;
  if (use == DetectorUse::Prepare) {
    scan->preparation = config.instrument.monitor ? Preparation::Monitor : Preparation::Look;
  }
}

void Sequencer::Impl::on_message(const MonitorReady& answer, Instant now) {
  if (!monitor_call || monitor_call->ticket != answer.ticket) return;
  const MonitorUse use = monitor_call->use;
  monitor_call.reset();
  if (use != MonitorUse::Prepare || !scan) return;
  if (answer.monitor) {
    scan->preparation = ActiveScan::Preparation::Look;
  } else {
    add_hold(hold_for(answer.monitor.error().code), "monitor", describe(answer.monitor.error()), now);
  }
}

void Sequencer::Impl::on_message(const MonitorAnswer& answer, Instant now) {
  if (!monitor_call || monitor_call->ticket != answer.ticket) return;
  const MonitorUse use = monitor_call->use;
  monitor_call.reset();
  if (use == MonitorUse::Reading) return on_monitor(answer.reading, now);
  if (use != MonitorUse::Lamp || !scan) return;
  if (!answer.reading) {
    return add_hold(hold_for(answer.reading.error().code), "monitor", describe(answer.reading.error()), now);
  }
  see_lamp(answer.reading->reading.mean_w, now);
  on_lamp_seen(now);
}

void Sequencer::Impl::on_message(const CommitAnswer& answer, Instant now) {
  const auto found = commits.find(answer.ticket);
  if (found == commits.end()) return;
  const PendingCommit pending = std::move(found->second);
  commits.erase(found);
  if (!answer.receipt) return store_failed(answer.receipt.error(), pending.reply_failure_to);
  // After a failure nothing in memory is believed any more; what did get written is found by the reload.
  if (store_error) return store_failed(*store_error, pending.reply_failure_to);
  pending.done(*answer.receipt, now);
}

void Sequencer::Impl::store_failed(const Error& error, std::optional<CommandId> command) {
  if (command) reply(*command, failure(error));
  for (const Command& waits : std::exchange(waiting, {})) reply(waits.id, failure(error));
  if (store_error) return;
  store_error = error;
  is_in_transition = false;
  if (!scan) return;
  scan->job.reset();
  scan->ahead.reset();
  disown_calls();
  scan->holds.push_back(Hold{.name = HoldName::Disk, .owner = "store", .reason = describe(error)});
}

void Sequencer::Impl::on_message(const UnfinishedAnswer& answer, Instant /*now*/) {
  if (load_call != answer.ticket) return;
  load_call.reset();
  const std::optional<CommandId> command = std::exchange(resume_command, std::nullopt);
  if (!answer.scans) {
    store_error = answer.scans.error();
    if (command) reply(*command, failure(answer.scans.error()));
    for (const Command& waits : std::exchange(waiting, {})) reply(waits.id, failure(answer.scans.error()));
    return;
  }
  store_error.reset();
  scan.reset();
  queue.clear();
  aside.clear();
  for (const UnfinishedScan& stored : *answer.scans) take_up(stored);
  if (!command) return;
  reply(*command, CommandDone{.scan = aside.empty() ? 0 : aside.back().id});
}

void Sequencer::Impl::on_message(const StopHappened& stop, Instant now) {
  epoch = std::max(epoch, stop.epoch);
  stage_stopped = true;
  if (store_error || load_call) return;  // halted all the same; the stage's own latch tells of it later
  const bool is_under_way = scan && scan->state != ScanState::Queued && !is_over(scan->state);
  commit({.at = now,
          .writes = {AuditEntry{.who = stop.who, .action = "stop"}},
          .events = {event_stop(is_under_way ? scan->id : 0, stop.who, stop.epoch)}},
         {.done = [](const CommitReceipt&, Instant) {}});
  if (!is_under_way) return;
  drop_job(now);
  add_hold(HoldName::Operator, stop.who, "STOP: reset the stage, then resume", now);
}

// ---- what is shown ----

std::string_view Sequencer::Impl::doing() const {
  if (hand_reading) return "read by hand";
  if (by_hand) return "moved by hand";
  if (!scan) return "idle";
  if (scan->warm_up_since && scan->state == ScanState::Preparing) return "waiting for the lamp to be warm";
  if (scan->state != ScanState::Running && scan->state != ScanState::Finishing) return scan_state_name(scan->state);
  if (!scan->job) return "committing";
  switch (scan->job->phase) {
    case Job::Phase::Homing:
      return "homing";
    case Job::Phase::ToMove:
    case Job::Phase::Moving:
      return "moving";
    case Job::Phase::InPlace:
      return "committing";
    case Job::Phase::Exposing:
      return scan->job->kind == Job::Kind::Dark ? "exposing the dark" : "exposing";
  }
  return "idle";
}

Progress Sequencer::Impl::progress() const {
  Progress p{.scan = scan->id,
             .name = scan->name,
             .state = scan->state,
             .holds = scan->holds,
             .points = static_cast<std::int64_t>(scan->points.size()),
             .merged = scan->merged,
             .items = scan->items.total(),
             .accepted = scan->items.accepted() - scan->uncommitted,
             .skipped = scan->items.skipped(),
             .failed_attempts = scan->failed_attempts,
             .spent = scan->spent};
  p.blocked = p.points - static_cast<std::int64_t>(scan->items.order().size());
  if (scan->job && scan->job->kind == Job::Kind::Item) p.in_hand = scan->job->item;
  if (scan->predicted) p.learned_from = scan->predicted->scans;
  if (!scan->end_estimate.is_ready()) {
    const double open = static_cast<double>(p.items - p.accepted - p.skipped) / static_cast<double>(p.items);
    if (scan->predicted) p.remaining = seconds(open * in_seconds(scan->predicted->total));
    if (scan->predicted) p.u_remaining = seconds(open * scan->predicted->u_s);
    return p;
  }
  const Remaining left = scan->end_estimate.of(work_left());
  p.remaining = seconds(left.time_s);
  p.u_remaining = seconds(std::sqrt(left.variance_s2));
  return p;
}

// References follow the way of their samples backwards, where each sample has one.
WorkLeft Sequencer::Impl::work_left() const {
  const ScanItems& items = scan->items;
  const WayAhead::Length ahead = scan->way.between(items.cursor(), items.order().size());
  const WayAhead::Length back =
      scan->way.between(items.cursor() - std::min(items.cursor(), items.owed()), items.cursor());
  constexpr double kUnseen = 0.1;  // of the way not looked at yet, relative
  const double ways = scan->policy.reference_mode == api::ReferenceMode::SameGeometry ? 2.0 : 1.0;
  WorkLeft left{.samples = items.open(calibration::Target::Sample),
                .references = items.open(calibration::Target::Reference),
                .way_s = ways * ahead.time_s + back.time_s,
                .u_way_s = kUnseen * (ways * ahead.unseen_s + back.unseen_s),
                .turns_s = scan->turns.time_s,
                .u_turns_s = scan->turns.u_s,
                .dark_every = scan->policy.dark_every};
  // As many lit visits an item as there were so far; the one that closes the scan at least.
  const auto open = static_cast<double>(left.samples + left.references);
  const auto made = static_cast<double>(scan->visit_time.count());
  const double visits = made > 0.0 ? std::max(1.0, made * open / static_cast<double>(scan->item_time.count())) : 0.0;
  left.other_visits = seconds(visits * scan->visit_time.mean_s());
  const auto& rungs = scan->chooser.rungs();
  for (std::size_t rung = scan->lowest_rung.value_or(0); rung <= scan->highest_rung.value_or(0); ++rung) {
    left.dark_light += dark_frames() * rungs[rung];
  }
  return left;
}

// At each turn, since it is not quite cheap.
void Sequencer::Impl::look_at_turns() {
  if (scan->policy.reference_mode != api::ReferenceMode::SameGeometry) return;  // visits turn, and count for themselves
  const ScanItems& items = scan->items;
  const drivers::AxisConfig& carriage = config.instrument.stage.axis(stage::Axis::Carriage);
  const CarriagePositions& places = config.instrument.carriage;
  const double way = in_millimetres(places.reference) - in_millimetres(places.sample);
  scan->turns = scan->way.turns(config.instrument, scan->points, items.order(),
                                {.begun = items.cursor() - std::min(items.cursor(), items.owed()),
                                 .is_on_reference = items.is_on_reference(),
                                 .work_s = scan->end_estimate.sample_work_s(),
                                 .pass_s = in_seconds(scan->policy.block) / 2.0,
                                 .to_reference_s = in_seconds(travel_time(carriage, way) + carriage.settle)});
}

SequencerStatus Sequencer::Impl::status(Instant now) const {
  SequencerStatus s{.doing = std::string(doing()), .stage_stopped = stage_stopped, .store_error = store_error};
  if (scan) s.active = progress();
  for (const ActiveScan& one : aside) s.aside.push_back(one.id);
  s.queued = queue_in_order();
  s.warm_up = warm_up_progress(now);
  return s;
}

}  // namespace gonio::daemon
