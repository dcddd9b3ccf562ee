#include "daemon/engine/stage_actor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <variant>

#include "daemon/engine/gate_watch.h"
#include "drivers/motion/homing_task.h"
#include "drivers/motion/move_task.h"
#include "drivers/motion/shutter_task.h"

namespace gonio::daemon {
namespace {

Ticket ticket_of(const StageRequest& request) {
  return std::visit([](const auto& r) { return r.ticket; }, request);
}

bool names_an_axis(const drivers::MotionTarget& target) {
  return std::ranges::any_of(target, [](const auto& wanted) { return wanted.has_value(); });
}

// A state machine of drivers/motion as a condition of a job.
template <class Task>
auto watch_of(Task task) {
  return
      [task = std::move(task)](const drivers::StageState& seen, Instant now) mutable { return task.look(seen, now); };
}

}  // namespace

StageActor::StageActor(drivers::Stage& stage, const drivers::StageConfig& config, Post post)
    : stage_(stage), config_(config), post_(std::move(post)) {}

void StageActor::on(const StageRequest& request, Instant now) {
  if (std::holds_alternative<LookAtStage>(request)) {
    post_({ticket_of(request), look()});
    return;
  }
  if (waiting_.size() >= kMostWaiting) {
    post_({ticket_of(request), failure({.code = ErrorCode::Busy,
                                        .device = "stage",
                                        .tried = "take a request",
                                        .seen = "too many wait already",
                                        .limit = std::to_string(kMostWaiting)})});
    return;
  }
  waiting_.push_back(request);
  if (!job_) static_cast<void>(step(now));
}

std::optional<Instant> StageActor::step(Instant now) {
  if (job_ && job_->next_look <= now) advance();
  while (!job_ && !waiting_.empty()) {
    const StageRequest next = std::move(waiting_.front());
    waiting_.pop_front();
    begin(next, now);
    if (job_ && job_->next_look <= now) advance();
  }
  if (!job_) return std::nullopt;
  return job_->next_look;
}

Result<drivers::StageState> StageActor::look() {
  after_gate_.reset();
  Result<drivers::StageState> state = stage_.read_state();
  if (state) note(*state);
  return state;
}

// The look that ended an exposure is as good as another one a moment later: what happens between either and the
// command is found by the command's epoch, the stop count and the boot counter.
Result<drivers::StageState> StageActor::look_before_a_move(Instant now) {
  std::optional<drivers::StageState> seen = std::exchange(after_gate_, std::nullopt);
  if (!seen || now - seen->at > kFresh) return look();
  seen->at = now;
  return *std::move(seen);
}

void StageActor::note(const drivers::StageState& seen) {
  if (boot_counter_ && *boot_counter_ != seen.boot_counter) slack_taken_up_.fill(false);
  boot_counter_ = seen.boot_counter;
  note_rest(seen);
}

// Kept until another motion is accepted: an axis that moves by itself afterwards is found however late it is looked at.
void StageActor::note_rest(const drivers::StageState& seen) {
  if (seen.moving) return;
  const bool is_known =
      left_ && left_->boot_counter == seen.boot_counter && left_->accepted_token == seen.accepted_token;
  if (!is_known) left_ = seen;
}

// Encoders count from one zero: when a reading has changed and nothing was asked to move, that zero is not to be
// trusted, and a move by the encoder would go to a wrong place and call it right.
Result<void> StageActor::check_rest(const MoveTo& request, const drivers::StageState& seen) const {
  const bool is_at_rest =
      left_ && !seen.moving && left_->boot_counter == seen.boot_counter && left_->accepted_token == seen.accepted_token;
  if (!is_at_rest) return {};
  for (const stage::Axis axis : stage::kAllAxes) {
    const std::size_t i = stage::index_of(axis);
    if (!left_->axes[i].homed || !seen.axes[i].homed) continue;
    const double moved = std::abs(seen.axes[i].position - left_->axes[i].position);
    if (moved <= config_.axis(axis).window) continue;
    return failure({.code = ErrorCode::OutOfTolerance,
                    .device = "stage",
                    .tried = drivers::motion_text(request.target),
                    .seen = fmt::format("{} shows {:.4f} {} and nothing has moved it: home the stage",
                                        stage::axis_name(axis), seen.axes[i].position, stage::axis_unit(axis)),
                    .limit = fmt::format("{:.4f} +- {:.4f} {}, where it was left", left_->axes[i].position,
                                         config_.axis(axis).window, stage::axis_unit(axis))});
  }
  return {};
}

void StageActor::begin(const StageRequest& request, Instant now) {
  Result<Job> started = failure(Error{});
  if (const auto* move = std::get_if<MoveTo>(&request)) started = start(*move, now);
  if (const auto* home = std::get_if<Home>(&request)) started = start(*home);
  if (const auto* reset = std::get_if<ResetStage>(&request)) started = start(*reset);
  if (const auto* gate = std::get_if<WatchGate>(&request)) {
    GateWatch watch(config_, *gate, boot_counter_, now);
    const Instant first = watch.first_look();
    started =
        Job{.ticket = gate->ticket, .watches = {watch_of(std::move(watch))}, .next_look = first, .is_of_a_gate = true};
  }
  if (started) {
    job_ = std::move(*started);
  } else {
    post_({ticket_of(request), failure(std::move(started).error())});
  }
}

Result<StageActor::Job> StageActor::start(const MoveTo& request, Instant now) {
  const Result<drivers::StageState> before = look_before_a_move(now);
  if (!before) return failure(before.error());
  Job job{.ticket = request.ticket, .next_look = before->at};
  if (!names_an_axis(request.target)) {
    GONIO_TRY(add_shutters(job, request, *before));
    return job;
  }
  GONIO_TRY(check_rest(request, *before));
  GONIO_TRY(check_arms_are_known(*before, request.target));
  auto legs = drivers::plan_route(config_, drivers::positions_of(*before), request.target, slack_taken_up_);
  if (!legs) return failure(legs.error());
  job.ends = legs->back();
  job.legs.assign(legs->begin(), legs->end());
  job.epoch = request.epoch;
  job.stop_count = before->stop_count;
  GONIO_TRY(add_shutters(job, request, *before));
  job.watches.emplace_back();  // the motion's
  GONIO_TRY(start_leg(job, *before));
  return job;
}

// Whether a way is clear can be said only of arms whose place is known.
Result<void> StageActor::check_arms_are_known(const drivers::StageState& before,
                                              const drivers::MotionTarget& target) const {
  if (!config_.keep_out) return {};
  for (const stage::Axis axis : {stage::Axis::ThetaI, stage::Axis::ThetaR, stage::Axis::PhiR, stage::Axis::PhiI}) {
    if (before.axes[stage::index_of(axis)].homed) continue;
    return failure({.code = ErrorCode::NotHomed,
                    .device = "stage",
                    .tried = drivers::motion_text(target),
                    .seen = std::string(stage::axis_name(axis)) + " is not homed",
                    .limit = "the arms' places known, to keep them apart"});
  }
  return {};
}

Result<void> StageActor::start_leg(Job& job, const drivers::StageState& before) {
  const drivers::MotionTarget leg = job.legs.front();
  if (before.stop_count != job.stop_count) {
    return failure({.code = ErrorCode::Stopped,
                    .device = "stage",
                    .tried = drivers::motion_text(leg),
                    .seen = "stop count " + std::to_string(before.stop_count),
                    .limit = "it was " + std::to_string(job.stop_count) + " when the move began"});
  }
  job.legs.pop_front();
  for (std::size_t a = 0; a < leg.size(); ++a) slack_taken_up_[a] = slack_taken_up_[a] && !leg[a];
  Result<drivers::StartedMove> started = stage_.start_move_and_look(leg, job.epoch);
  if (!started) return failure(started.error());
  job.seen = std::move(started->seen);
  using Ending = drivers::MoveTask::Ending;
  job.watches.back() = watch_of(drivers::MoveTask(config_, before, leg, started->token, job.epoch, before.at,
                                                  job.legs.empty() ? Ending::Settle : Ending::Rest));
  job.next_look = before.at;
  return {};
}

Result<void> StageActor::add_shutters(Job& job, const MoveTo& request, const drivers::StageState& before) {
  if (!request.source_shutter_open && !request.detector_shutter_open) return {};
  const bool source = request.source_shutter_open.value_or(before.source_shutter == stage::ShutterState::Open);
  const bool detector = request.detector_shutter_open.value_or(before.detector_shutter == stage::ShutterState::Open);
  const auto stands = [](stage::ShutterState shutter, bool open) {
    return shutter == (open ? stage::ShutterState::Open : stage::ShutterState::Closed);
  };
  if (stands(before.source_shutter, source) && stands(before.detector_shutter, detector)) return {};
  GONIO_TRY(stage_.set_shutters(source, detector));
  job.watches.push_back(watch_of(drivers::ShutterTask(config_, before, source, detector, before.at)));
  return {};
}

Result<StageActor::Job> StageActor::start(const Home& request) {
  const Result<drivers::StageState> before = look();
  if (!before) return failure(before.error());
  slack_taken_up_.fill(false);
  const Result<drivers::MotionToken> token = stage_.start_homing(request.epoch);
  if (!token) return failure(token.error());
  return Job{.ticket = request.ticket,
             .watches = {watch_of(drivers::HomingTask(config_, *before, *token, request.epoch, before->at))},
             .next_look = before->at};
}

Result<StageActor::Job> StageActor::start(const ResetStage& request) {
  GONIO_TRY(stage_.reset(request.epoch));
  return Job{.ticket = request.ticket};  // no condition: the state after it is the answer
}

Result<drivers::StageState> StageActor::look_for_the_job() {
  if (!job_->seen) return look();
  const drivers::StageState seen = *std::exchange(job_->seen, std::nullopt);
  note(seen);
  return seen;
}

void StageActor::advance() {
  const Result<drivers::StageState> seen = look_for_the_job();
  Result<bool> all_done = seen ? Result<bool>(true) : failure(seen.error());
  std::optional<Instant> next;
  for (Watch& watch : job_->watches) {
    if (!all_done) break;
    const auto progress = watch(*seen, seen->at);
    if (!progress) {
      all_done = failure(progress.error());
    } else if (!progress->is_done) {
      all_done = false;
      next = next ? std::min(*next, progress->next_look) : progress->next_look;
    }
  }
  if (all_done && !*all_done) {
    job_->next_look = *next;
    return;
  }
  if (all_done && !job_->legs.empty()) {
    const Result<void> started = start_leg(*job_, *seen);
    return started ? void() : finish(failure(started.error()));
  }
  finish(all_done ? seen : failure(std::move(all_done).error()));
}

void StageActor::finish(const Result<drivers::StageState>& state) {
  for (std::size_t a = 0; state && a < slack_taken_up_.size(); ++a) {
    if (job_->ends[a]) slack_taken_up_[a] = true;
  }
  const Ticket ticket = job_->ticket;
  if (state && job_->is_of_a_gate) after_gate_ = *state;
  job_.reset();
  post_({ticket, state});
}

}  // namespace gonio::daemon
