#include "daemon/engine/stage_actor.h"

#include <algorithm>
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
  Result<drivers::StageState> state = stage_.read_state();
  if (state) boot_counter_ = state->boot_counter;
  return state;
}

void StageActor::begin(const StageRequest& request, Instant now) {
  Result<Job> started = failure(Error{});
  if (const auto* move = std::get_if<MoveTo>(&request)) started = start(*move);
  if (const auto* home = std::get_if<Home>(&request)) started = start(*home);
  if (const auto* reset = std::get_if<ResetStage>(&request)) started = start(*reset);
  if (const auto* gate = std::get_if<WatchGate>(&request)) {
    GateWatch watch(config_, *gate, boot_counter_, now);
    const Instant first = watch.first_look();
    started = Job{gate->ticket, {watch_of(std::move(watch))}, first};
  }
  if (started) {
    job_ = std::move(*started);
  } else {
    post_({ticket_of(request), failure(std::move(started).error())});
  }
}

Result<StageActor::Job> StageActor::start(const MoveTo& request) {
  const Result<drivers::StageState> before = look();
  if (!before) return failure(before.error());
  Job job{request.ticket, {}, before->at};
  GONIO_TRY(add_shutters(job, request, *before));
  if (!names_an_axis(request.target)) return job;
  const Result<drivers::MotionToken> token = stage_.start_move(request.target, request.epoch);
  if (!token) return failure(token.error());
  job.watches.push_back(
      watch_of(drivers::MoveTask(config_, *before, request.target, *token, request.epoch, before->at)));
  return job;
}

Result<void> StageActor::add_shutters(Job& job, const MoveTo& request, const drivers::StageState& before) {
  if (!request.source_shutter_open && !request.detector_shutter_open) return {};
  const bool source = request.source_shutter_open.value_or(before.source_shutter == stage::ShutterState::Open);
  const bool detector = request.detector_shutter_open.value_or(before.detector_shutter == stage::ShutterState::Open);
  GONIO_TRY(stage_.set_shutters(source, detector));
  job.watches.push_back(watch_of(drivers::ShutterTask(config_, before, source, detector, before.at)));
  return {};
}

Result<StageActor::Job> StageActor::start(const Home& request) {
  const Result<drivers::StageState> before = look();
  if (!before) return failure(before.error());
  const Result<drivers::MotionToken> token = stage_.start_homing(request.epoch);
  if (!token) return failure(token.error());
  return Job{
      request.ticket, {watch_of(drivers::HomingTask(config_, *before, *token, request.epoch, before->at))}, before->at};
}

Result<StageActor::Job> StageActor::start(const ResetStage& request) {
  GONIO_TRY(stage_.reset(request.epoch));
  return Job{request.ticket, {}, {}};  // no condition: the state after it is the answer
}

void StageActor::advance() {
  const Result<drivers::StageState> seen = look();
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
  const Ticket ticket = job_->ticket;
  job_.reset();
  post_({ticket, all_done ? seen : failure(std::move(all_done).error())});
}

}  // namespace gonio::daemon
