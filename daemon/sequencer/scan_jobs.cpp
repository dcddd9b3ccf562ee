#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/planner/planner.h"
#include "daemon/sequencer/failure_policy.h"
#include "daemon/sequencer/held_window.h"
#include "daemon/sequencer/scan_events.h"
#include "daemon/sequencer/sequencer_impl.h"

namespace gonio::daemon {

namespace {

using calibration::Target;
using stage::Axis;

bool moves_an_axis(const drivers::MotionTarget& target) {
  return std::ranges::any_of(target, [](const auto& place) { return place.has_value(); });
}

// A radiometer's word counts instead of the stage's own.
void set_monitor(drivers::GateRecord& gate, const calibration::PowerReading& monitor) {
  gate.monitor_mean = monitor.mean_w;
  gate.monitor_se = monitor.standard_error_w;
  gate.monitor_samples = static_cast<std::uint32_t>(monitor.samples);
}

Instant middle_of(const Job& job, Duration exposure) {
  const auto& power = job.frame->power;
  return power ? power->started + (power->ended - power->started) / 2 : job.asked + exposure / 2;
}

ReadingRecord reading_from(const Job& job, Duration exposure) {
  const FrameSummary& frame = *job.frame;
  const drivers::StageState& after = *job.gate;
  return ReadingRecord{.region = frame.region,
                       .reduced = frame.reduced,
                       .maps_version = frame.maps_version,
                       .settings = frame.settings,
                       .camera_frame_id = frame.frame_id,
                       .camera_time_ns = frame.camera_time_ns,
                       .camera_temperature_c = frame.temperature_c,
                       .gate_count = after.gate.count,
                       .open_counts = after.gate.open_counts,
                       .close_counts = after.gate.close_counts,
                       .monitor_mean = after.gate.monitor_mean,
                       .monitor_se = after.gate.monitor_se,
                       .monitor_samples = after.gate.monitor_samples,
                       .lamp_temperature_c = after.lamp_temperature_c,
                       .detector_temperature_c = after.detector_temperature_c,
                       .room_temperature_c = after.room_temperature_c,
                       .humidity_percent = after.humidity_percent,
                       .at = middle_of(job, exposure),
                       .power = frame.power,
                       .monitor_power = job.monitor};
}

// The dark, and the standard, which is the even light. The sample's own pattern is no map of pixels.
bool keeps_sums(const ActiveScan& scan, const Job& job) {
  const bool is_of_standard = job.kind == Job::Kind::Item && job.item.target == Target::Reference;
  return scan.policy.map_frames > 0 && (job.kind == Job::Kind::Dark || is_of_standard);
}

std::shared_ptr<calibration::PixelSums> sums_for(Job& job, std::size_t rung) {
  auto& sums = job.pixel_sums[rung];
  if (!sums) sums = std::make_shared<calibration::PixelSums>();
  return sums;
}

}  // namespace

// ---- beginning ----

Job Sequencer::Impl::new_job(Job::Kind kind, Instant now) {
  Job job{.kind = kind, .started = now};
  job.time.idle = std::exchange(scan->between, {});
  return job;
}

void Sequencer::Impl::start_item(const ItemKey& item, Instant now) {
  scan->job = new_job(Job::Kind::Item, now);
  scan->job->item = item;
  if (const auto aimed = aim(*scan->job); !aimed) return job_failed(aimed.error(), now);
  begin_measurement(*scan->job);
}

Result<void> Sequencer::Impl::aim(Job& job) const {
  const ScanPoint& point = scan->points[static_cast<std::size_t>(job.item.point)];
  auto target = axis_targets(point.geometry, point.wavelength, config.instrument,
                             stage ? positions_of(*stage) : home_position(config.instrument));
  if (!target) return failure(target.error());
  (*target)[stage::index_of(Axis::Carriage)] =
      in_millimetres(carriage_place(config.instrument, job.item.target, point.geometry));
  job.target = *target;
  return {};
}

void Sequencer::Impl::begin_measurement(Job& job) const {
  const auto filter = static_cast<int>(std::lround(job.target[stage::index_of(Axis::FilterWheel)].value_or(0.0)));
  job.measurement = Measurement::of_item(job.chooser ? *job.chooser : scan->chooser, job.item.target, filter);
}

void Sequencer::Impl::start_park(Instant now) {
  scan->job = new_job(Job::Kind::Park, now);
}

void Sequencer::Impl::drive_job(Instant now) {
  Job& job = *scan->job;
  if (!channels_are_free()) return;
  if (job.phase == Job::Phase::ToMove && scan->is_position_in_doubt) {
    job.phase = Job::Phase::Homing;
    job.asked = now;
    scan->ledger.enter(job.time.idle.planning, now);
    return ask_stage(StageUse::HomeAgain, gonio::daemon::Home{.epoch = epoch});
  }
  if (job.phase == Job::Phase::ToMove) return ask_to_move(job, now);
  if (job.phase != Job::Phase::InPlace) return;
  if (job.kind == Job::Kind::Park) {
    const bool is_early = scan->items.open(Target::Sample) + scan->items.open(Target::Reference) > 0;
    scan->job.reset();
    return transition(is_early ? ScanEvent::ParkedEarly : ScanEvent::Parked, now, kDaemon,
                      is_early ? "finished early, data kept" : "complete");
  }
  // At most one item is ever uncommitted: its commit returns before the next light is taken.
  if (!has_uncommitted_item()) return begin_exposure(now);
  job.awaits_commit = true;
}

void Sequencer::Impl::ask_to_move(Job& job, Instant now) {
  job.phase = Job::Phase::Moving;
  job.asked = now;
  scan->ledger.enter(job.is_going_back ? job.time.idle.device : job.time.idle.planning, now);
  job.model = model_of(job.target);
  ask_stage(StageUse::Move, MoveTo{.epoch = epoch,
                                   .target = job.target,
                                   .source_shutter_open = job.kind != Job::Kind::Park,
                                   .detector_shutter_open = job.is_lit()});
}

void Sequencer::Impl::on_homed_again(const Result<drivers::StageState>& state, Instant now) {
  if (!scan || !scan->job) return;
  if (!state) return job_failed(state.error(), now);
  scan->is_position_in_doubt = false;
  scan->ledger.enter(scan->job->time.idle.device, now);
  scan->job->phase = Job::Phase::ToMove;
}

void Sequencer::Impl::on_moved(const Result<drivers::StageState>& state, Instant now) {
  if (!scan || !scan->job) return;
  Job& job = scan->ahead ? *scan->ahead : *scan->job;
  if (!state && scan->ahead) {
    job.error = state.error();  // its turn has not come
    return;
  }
  if (!state) return job_failed(state.error(), now);
  if (std::exchange(job.is_going_back, false)) scan->ledger.enter(job.time.idle.device, now);
  if (!moves_an_axis(job.target)) scan->ledger.enter(job.time.move, now);  // the shutters
  scan->ledger.enter_first(job.model.move, job.time.move, now);
  scan->ledger.enter(job.model.settle, job.time.settle, job.time.idle.wire, now);
  job.phase = Job::Phase::InPlace;
}

// ---- exposing ----

void Sequencer::Impl::begin_exposure(Instant now) {
  Job& job = *scan->job;
  const Duration exposure = scan->chooser.rungs()[job.measurement->rung()];
  scan->ledger.enter(job.awaits_commit ? job.time.idle.commit : job.time.idle.planning, now);
  job.awaits_commit = false;
  job.phase = Job::Phase::Exposing;
  job.asked = now;
  job.gate.reset();
  job.frame.reset();
  job.gate_error.reset();
  job.before.reset();
  job.monitor.reset();
  job.gate_before = stage->gate.count;
  if (!config.instrument.has_gate()) return ask_stage(StageUse::Before, LookAtStage{});
  ask_stage(StageUse::Gate, WatchGate{.after = job.gate_before, .expected = exposure, .held = job.target});
  take_light(now);
}

void Sequencer::Impl::take_light(Instant now) {
  Job& job = *scan->job;
  const std::size_t rung = job.measurement->rung();
  const Duration exposure = scan->chooser.rungs()[rung];
  job.asked = now;
  scan->ledger.enter(job.time.idle.wire, now);  // a look before it, where no gate latches
  if (config.instrument.monitor) ask_monitor(MonitorUse::Reading, TakeMonitor{.window = exposure});
  ask_detector(DetectorUse::Frame,
               TakeFrame{.settings = {.exposure = exposure, .gain_db = config.instrument.detector.gain_db},
                         .power = scan->power_settings(rung),
                         .sums = keeps_sums(*scan, job) ? sums_for(job, rung) : nullptr});
}

// Without a gate the encoders are read before and after: the exposure begins when the first look has come, and the
// second is asked for when its light is there.
void Sequencer::Impl::on_before(const Result<drivers::StageState>& state, Instant now) {
  if (!scan || !scan->job) return;
  if (!state) return job_failed(state.error(), now);
  const auto held = check_held(config.instrument, scan->job->target, *state, "before");
  if (!held) return job_failed(held.error(), now);
  scan->job->before = *state;
  take_light(now);
}

void Sequencer::Impl::on_after(const Result<drivers::StageState>& state, Instant now) {
  if (!scan || !scan->job) return;
  if (!state) return job_failed(state.error(), now);
  const auto held = check_held(config.instrument, scan->job->target, *state, "after");
  if (!held) return job_failed(held.error(), now);
  const auto record = window_record(*scan->job->before, *state);
  if (!record) return job_failed(record.error(), now);
  scan->job->gate = *state;
  scan->job->gate->gate = *record;
  join_exposure(now);
}

void Sequencer::Impl::on_monitor(const Result<PowerRecord>& reading, Instant now) {
  if (!scan || !scan->job) return;
  if (!reading) return job_failed(reading.error(), now);
  scan->job->monitor = *reading;
  join_exposure(now);
}

void Sequencer::Impl::on_gate(const Result<drivers::StageState>& state, Instant now) {
  if (!scan || !scan->job) return;
  if (!state && state.error().code == ErrorCode::TimedOut && !scan->job->frame) {
    // A camera that is gone opens no gate. Its own answer, due within its deadline, then names the cause.
    scan->job->gate_error = state.error();
    return;
  }
  if (!state) return job_failed(state.error(), now);
  if (state->gate.count != scan->job->gate_before + 1) {
    return job_failed(Error{.code = ErrorCode::StaleData,
                            .device = "stage",
                            .tried = "pair a frame with the stage's gate",
                            .seen = fmt::format("gate count {}", state->gate.count),
                            .limit = fmt::format("{}", scan->job->gate_before + 1)},
                      now);
  }
  scan->job->gate = *state;
  count_light(*scan->job, now);
  leave_early(now);
  join_exposure(now);
}

void Sequencer::Impl::on_frame(const Result<FrameSummary>& frame, Instant now) {
  if (!scan || !scan->job) return;
  if (!frame) return job_failed(frame.error(), now);
  if (scan->job->gate_error) return job_failed(Error(*scan->job->gate_error), now);
  scan->job->frame = *frame;
  join_exposure(now);
}

void Sequencer::Impl::join_exposure(Instant now) {
  Job& job = *scan->job;
  if (!job.frame || (config.instrument.monitor && !job.monitor)) return;
  if (!job.gate) {
    if (config.instrument.has_gate()) return;
    count_light(job, now);
    return ask_stage(StageUse::After, LookAtStage{});
  }
  const Duration exposure = scan->chooser.rungs()[job.measurement->rung()];
  if (!scan->ahead) scan->ledger.enter(config.instrument.has_gate() ? job.time.read : job.time.idle.wire, now);
  scan->chooser.learn_frame_time(std::max(Duration::zero(), now - job.asked - exposure));
  if (job.monitor) set_monitor(job.gate->gate, job.monitor->reading);
  const auto verdict = job.measurement->add(reading_from(job, exposure), job.chooser ? *job.chooser : scan->chooser);
  if (lamp_is_out(job.gate->gate, now)) return drop_job(now);
  if (verdict == Measurement::Verdict::Saturated) {
    return job_failed(Error{.code = ErrorCode::Saturated,
                            .device = "detector",
                            .tried = fmt::format("expose for {:.6f} s, the shortest there is", in_seconds(exposure)),
                            .seen = fmt::format("{} pixels of the aperture at full scale", job.frame->region.saturated),
                            .limit = "none"},
                      now);
  }
  if (verdict == Measurement::Verdict::Done) return accept_job(now);
  if (scan->ahead) return go_back(now);
  job.phase = Job::Phase::InPlace;
}

// The light is over: what is not the exposure's own was the wires'.
void Sequencer::Impl::count_light(Job& job, Instant now) {
  scan->ledger.enter(scan->chooser.rungs()[job.measurement->rung()], job.time.expose, job.time.idle.wire, now);
}

bool Sequencer::Impl::lamp_is_out(const drivers::GateRecord& gate, Instant now) {
  see_lamp(gate.monitor_mean, now);
  constexpr std::uint32_t kFewestToJudge = 4;  // two samples of a live one may well be the same
  const LampBand& band = config.instrument.lamp;
  const double scatter = gate.monitor_se * std::sqrt(static_cast<double>(gate.monitor_samples));
  const double least = band.least_scatter * gate.monitor_mean;
  if (gate.monitor_mean < band.low || gate.monitor_mean > band.high) {
    add_hold(HoldName::Lamp, "stage",
             fmt::format("lamp monitor {:.4g}, limits {:.4g} to {:.4g}: the lamp, or its monitor, has failed",
                         gate.monitor_mean, band.low, band.high),
             now);
  } else if (gate.monitor_samples >= kFewestToJudge && scatter < least) {
    add_hold(
        HoldName::Lamp, "stage",
        fmt::format("lamp monitor stuck at {:.6g}: its {} samples scatter by {:.2g}, a live one's by {:.2g} or more",
                    gate.monitor_mean, gate.monitor_samples, scatter, least),
        now);
  } else {
    return false;
  }
  return true;
}

// ---- done ----

StepTime Sequencer::Impl::model_of(const drivers::MotionTarget& target) const {
  if (!stage || !moves_an_axis(target)) return {};
  return step_time(config.instrument, positions_of(*stage), target).value_or(StepTime{});
}

NewAttempt Sequencer::Impl::attempt_of(Job& job, AttemptOutcome outcome, Instant now) {
  if (!scan->ahead) scan->ledger.enter(job.time.idle.planning, now);
  NewAttempt attempt{.scan = scan->id, .item = job.item, .outcome = outcome, .time = job.time, .started = job.started};
  if (job.measurement) attempt.readings = job.measurement->readings();
  return attempt;
}

void Sequencer::Impl::accept_job(Instant now) {
  Job job = *std::exchange(scan->job, std::nullopt);
  scan->spent += job.time;
  if (job.kind == Job::Kind::Item) accept_item(job, now);
  if (job.kind == Job::Kind::Dark) accept_dark(job, now);
  if (job.is_visit() && job.is_lit()) accept_visit(job, now);
  if (scan->ahead) take_up_ahead(now);
}

void Sequencer::Impl::accept_item(Job& job, Instant now) {
  NewAttempt attempt = attempt_of(job, AttemptOutcome::Accepted, now);
  attempt.pixel_sums = job.complete_sums();
  for (const std::size_t rung : job.measurement->used_rungs()) scan->note_rung(rung);
  scan->most_frames = std::max(scan->most_frames, job.measurement->used_frames());
  scan->items.accept(job.item, now);
  scan->failures.erase(job.item);
  scan->dark_owed = true;
  scan->reference_visits.note(job.item, scan->points);
  scan->check_visits.since.push_back(job.item);
  ++scan->uncommitted;
  const bool is_turn = std::exchange(scan->last_target, job.item.target) != job.item.target;
  scan->item_time.add(job.time.total());
  scan->end_estimate.add_item(job.item.target, job.time, job.model, is_turn);
  constexpr std::int64_t kEarly = 16;  // the way was hardly known at the first turn
  if (is_turn || scan->items.accepted() == kEarly) look_at_turns();
  commit({.at = now, .writes = {attempt}, .events = {event_attempt(attempt, *job.measurement)}},
         {.done =
              [this](const CommitReceipt&, Instant) {
                if (scan) --scan->uncommitted;
              },
          .holds_exposures = true});
}

// ---- not done ----

void Sequencer::Impl::drop_job(Instant now) {
  if (!scan->job) return;
  drop_ahead(now);
  disown_calls();
  Job job = *std::exchange(scan->job, std::nullopt);
  if (job.kind != Job::Kind::Item || !job.measurement || job.measurement->readings().empty()) {
    return count_as_lost(job, now);
  }
  const NewAttempt attempt = attempt_of(job, AttemptOutcome::Dropped, now);
  scan->spent += attempt.time;
  commit({.at = now, .writes = {attempt}, .events = {event_attempt(attempt, *job.measurement)}},
         {.done = [](const CommitReceipt&, Instant) {}});
}

void Sequencer::Impl::job_failed(const Error& error, Instant now) {
  drop_ahead(now);
  disown_calls();
  if (error.code == ErrorCode::Stopped || error.code == ErrorCode::StaleEpoch) stage_stopped = true;
  const bool was_elsewhere = error.code == ErrorCode::OutOfTolerance || error.code == ErrorCode::MotionLate;
  if (was_elsewhere && error.device == "stage") scan->is_position_in_doubt = true;
  const bool is_item = scan->job->kind == Job::Kind::Item;
  if (is_item && reaction_to(error) != Reaction::Hold) return item_failed(error, now);
  if (scan->job->is_visit() && reaction_to(error) != Reaction::Hold) return visit_failed(error, now);
  drop_job(now);
  scan->job.reset();
  add_hold(hold_for(error.code), error.device.empty() ? kDaemon : error.device, describe(error), now);
}

// Time that leaves no attempt and no visit: the next one bears it.
void Sequencer::Impl::count_as_lost(const Job& job, Instant now) {
  scan->ledger.enter(scan->between.device, now);
  scan->between.device += job.time.total();
}

void Sequencer::Impl::item_failed(const Error& error, Instant now) {
  Job job = *std::exchange(scan->job, std::nullopt);
  NewAttempt attempt = attempt_of(job, AttemptOutcome::Failed, now);
  attempt.error = error;
  scan->spent += attempt.time;
  ++scan->failed_attempts;
  const Measurement nothing = Measurement::of_dark(0, 0, 1);
  StoreTransaction transaction{
      .at = now, .writes = {attempt}, .events = {event_attempt(attempt, job.measurement ? *job.measurement : nothing)}};
  const Reaction reaction = reaction_to(error);
  const int failures = ++scan->failures[job.item];
  if (reaction != Reaction::GiveUpItem && failures <= scan->policy.item_retries) {
    commit(std::move(transaction), {.done = [](const CommitReceipt&, Instant) {}});
    return start_item(job.item, now);
  }
  if (reaction == Reaction::TryAgainThenHold) {
    scan->failures.erase(job.item);  // the operator's resume gives it its tries again
    commit(std::move(transaction), {.done = [](const CommitReceipt&, Instant) {}});
    return add_hold(HoldName::Device, error.device, describe(error), now);
  }
  give_up_item(job.item, error, std::move(transaction), now);
}

void Sequencer::Impl::give_up_item(const ItemKey& item, const Error& error, StoreTransaction transaction, Instant now) {
  const std::string reason = describe(error);
  if (scan->policy.on_item_error == api::OnItemError::Skip) {
    for (const ItemKey& gone : scan->items.give_up(item)) {
      const SkipItem skip{.scan = scan->id, .item = gone, .who = kDaemon, .reason = reason};
      transaction.writes.emplace_back(skip);
      transaction.events.push_back(event_skipped(skip));
    }
  }
  commit(std::move(transaction), {.done = [](const CommitReceipt&, Instant) {}});
  const std::string what = fmt::format("point {} ({}): {}", item.point, target_name(item.target), reason);
  if (scan->policy.on_item_error == api::OnItemError::Hold) {
    scan->failures.erase(item);
    return add_hold(HoldName::Device, kDaemon, what, now);
  }
  if (scan->policy.on_item_error == api::OnItemError::Fail && !is_in_transition) {
    transition(ScanEvent::Fail, now, kDaemon, what);
  }
}

}  // namespace gonio::daemon
