#include "sim/devices/stage_model.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace gonio::sim {

using stage::Axis;
using stage::Refusal;
using stage::ShutterState;
using stage::StatusBit;

namespace {

std::optional<Instant> earlier(std::optional<Instant> a, std::optional<Instant> b) {
  if (a && b) return std::min(*a, *b);
  return a ? a : b;
}

bool is_masked(const MotionCommand& command, Axis axis) {
  return (command.mask >> stage::index_of(axis) & 1U) != 0;
}

void set_shutter(ShutterModel& shutter, bool open, Duration travel, Instant now) {
  if (shutter.wants_open == open) return;
  shutter.wants_open = open;
  shutter.done = now + travel;
}

}  // namespace

ShutterState ShutterModel::state(Instant t) const {
  if (t < done) return ShutterState::Moving;
  return wants_open ? ShutterState::Open : ShutterState::Closed;
}

StageModel::StageModel(const StageSpec& spec, double time_scale, const StageMemory& memory, Instant power_up)
    : shutter_time_(seconds(spec.shutter_s / time_scale)),
      boot_counter_(memory.boot_counter + 1),
      moves_(memory.moves),
      last_beat_(power_up) {
  axes_.reserve(stage::kAxisCount);
  for (const Axis axis : stage::kAllAxes) {
    const std::size_t a = stage::index_of(axis);
    const AxisSpec& axis_spec = spec.axes[a];
    const double home = std::clamp(0.0, axis_spec.low, axis_spec.high);
    axes_.emplace_back(axis_spec, spec.registers.axis_scale[a], time_scale, spec.following_error_s,
                       memory.positions ? (*memory.positions)[a] : home, memory.lags[a]);
  }
}

std::optional<Instant> StageModel::heartbeat_due() const {
  if (heartbeat_timeout_ms_ == 0 || is_tripped_) return std::nullopt;
  return last_beat_ + std::chrono::milliseconds(heartbeat_timeout_ms_);
}

std::optional<Instant> StageModel::next_event() const {
  std::optional<Instant> next = heartbeat_due();
  for (const AxisModel& axis : axes_) next = earlier(next, axis.next_event());
  for (const Axis a : stage::kAllAxes) next = earlier(next, drive_watch_due(a));
  return next;
}

void StageModel::advance_to(Instant now) {
  for (auto due = next_event(); due && *due <= now; due = next_event()) {
    bool has_fault = false;
    for (AxisModel& axis : axes_) {
      if (!axis.advance_to(*due)) continue;
      fault_ = axis.fault();
      has_fault = true;
    }
    trip_drives(*due);
    const auto beat_due = heartbeat_due();
    const bool trips = beat_due && *beat_due <= *due;
    if (trips) is_tripped_ = true;
    if (has_fault || trips) brake_all(*due);
  }
}

void StageModel::brake_all(Instant now) {
  for (AxisModel& axis : axes_) axis.brake(now);
  ++stop_count_;
}

Refusal StageModel::judge(const MotionCommand& command, Instant now) const {
  constexpr unsigned kAllMasked = (1U << stage::kAxisCount) - 1U;
  const bool is_move = command.command == stage::kCommandMove || command.command == stage::kCommandMoveTogether;
  if (!is_move && command.command != stage::kCommandHome) return Refusal::BadCommand;
  if (is_move && (command.mask == 0 || command.mask > kAllMasked)) return Refusal::BadCommand;
  if (command.epoch < epoch_) return Refusal::EpochTooOld;
  if (is_halted_) return Refusal::Halted;
  if (is_tripped_) return Refusal::HeartbeatTripped;
  if (is_interlock_open_) return Refusal::InterlockOpen;
  if (fault_ != 0) return Refusal::Fault;
  if (is_moving(now)) return Refusal::AlreadyMoving;
  if (!is_move) return Refusal::None;
  for (const Axis a : stage::kAllAxes) {
    if (!is_masked(command, a)) continue;
    if (!axis(a).is_homed()) return Refusal::NotHomed;
    if (!axis(a).is_within_limits(axis(a).target_of_counts(command.targets[stage::index_of(a)])))
      return Refusal::BeyondLimit;
  }
  return Refusal::None;
}

void StageModel::command_motion(const MotionCommand& command, Instant now) {
  const Refusal refusal = judge(command, now);
  if (refusal != Refusal::None) {
    answer_.refused_token = command.token;
    answer_.refusal = refusal;
    return;
  }
  answer_.accepted_token = command.token;
  ++moves_;
  ++motion_commands_;
  for (AxisModel& axis : axes_) {
    if (command.command == stage::kCommandHome) axis.home(moves_, now);
  }
  if (command.command == stage::kCommandMove) move_each(command, now);
  if (command.command == stage::kCommandMoveTogether) move_together(command, now);
  advance_to(now);  // an axis that stands at its home already is homed at once
}

void StageModel::move_each(const MotionCommand& command, Instant now) {
  for (const Axis a : stage::kAllAxes) {
    if (!is_masked(command, a)) continue;
    AxisModel& axis = axes_[stage::index_of(a)];
    axis.move_to(axis.target_of_counts(command.targets[stage::index_of(a)]), moves_, now);
  }
}

// All go the same part of their ways in the same time: what one may do, as a part of its way, all do.
void StageModel::move_together(const MotionCommand& command, Instant now) {
  stage::PerAxis<double> ways{};
  AxisDynamics common{.speed = std::numeric_limits<double>::infinity(),
                      .acceleration = std::numeric_limits<double>::infinity()};
  for (const Axis a : stage::kAllAxes) {
    const AxisModel& axis = axes_[stage::index_of(a)];
    double& way = ways[stage::index_of(a)];
    if (!is_masked(command, a)) continue;
    way = std::abs(axis.target_of_counts(command.targets[stage::index_of(a)]) - axis.position(now));
    if (way == 0.0) continue;
    common.speed = std::min(common.speed, axis.dynamics().speed / way);
    common.acceleration = std::min(common.acceleration, axis.dynamics().acceleration / way);
  }
  for (const Axis a : stage::kAllAxes) {
    AxisModel& axis = axes_[stage::index_of(a)];
    if (!is_masked(command, a)) continue;
    const double way = ways[stage::index_of(a)];
    const AxisDynamics own = way == 0.0 ? axis.dynamics() : AxisDynamics{common.speed * way, common.acceleration * way};
    axis.move_to(axis.target_of_counts(command.targets[stage::index_of(a)]), own, moves_, now);
  }
}

void StageModel::halt(std::uint32_t epoch, Instant now) {
  epoch_ = std::max(epoch_, epoch);
  is_halted_ = true;
  brake_all(now);
}

bool StageModel::reset(std::uint32_t epoch, Instant now) {
  if (epoch < epoch_) return false;
  is_halted_ = false;
  is_tripped_ = false;
  last_beat_ = now;  // the watch starts afresh, or it would trip again at once
  fault_ = 0;
  for (AxisModel& axis : axes_) {
    axis.clear_fault();
    if (axis.fault() != 0) fault_ = axis.fault();
  }
  return true;
}

void StageModel::set_shutters(bool source_open, bool detector_open, Instant now) {
  ++shutter_commands_;
  set_shutter(source_shutter_, source_open, shutter_time_, now);
  set_shutter(detector_shutter_, detector_open, shutter_time_, now);
}

void StageModel::beat(std::uint16_t value, Instant now) {
  heartbeat_seen_ = value;
  last_beat_ = now;
}

void StageModel::watch_heartbeat(std::uint16_t timeout_ms, Instant now) {
  heartbeat_timeout_ms_ = timeout_ms;
  last_beat_ = now;
}

void StageModel::open_gate(Instant now) {
  ++gate_.count;
  gate_.is_open = true;
  pending_open_ = latched(now);
}

void StageModel::close_gate(Instant now, const MonitorReading& monitor) {
  gate_.is_open = false;
  gate_.open_counts = pending_open_;
  gate_.close_counts = latched(now);
  gate_.monitor = monitor;
}

stage::PerAxis<std::int32_t> StageModel::latched(Instant now) const {
  stage::PerAxis<std::int32_t> counts{};
  for (const Axis a : stage::kAllAxes) counts[stage::index_of(a)] = axis(a).counts(now);
  return counts;
}

void StageModel::set_interlock(bool is_open, Instant now) {
  if (is_open && !is_interlock_open_) brake_all(now);
  is_interlock_open_ = is_open;
}

void StageModel::hit_limit(Axis axis, Instant now) {
  AxisModel& hit = axes_[stage::index_of(axis)];
  hit.hit_limit(now);
  fault_ = hit.fault();
  brake_all(now);
}

bool StageModel::is_moving(Instant t) const {
  return std::ranges::any_of(axes_, [&](const AxisModel& axis) { return axis.is_moving(t); });
}

bool StageModel::is_homed() const {
  return std::ranges::all_of(axes_, &AxisModel::is_homed);
}

std::uint16_t StageModel::status_word(Instant t) const {
  unsigned word = 0;
  const auto set = [&](StatusBit b, bool on) { word |= on ? stage::bit(b) : 0U; };
  set(StatusBit::Moving, is_moving(t));
  set(StatusBit::Homed, is_homed());
  set(StatusBit::Halted, is_halted_);
  set(StatusBit::HeartbeatTripped, is_tripped_);
  set(StatusBit::Fault, fault_ != 0);
  set(StatusBit::InterlockOpen, is_interlock_open_);
  return static_cast<std::uint16_t>(word);
}

StageMemory StageModel::memory(Instant now) const {
  StageMemory memory{.boot_counter = boot_counter_, .positions = stage::PerAxis<double>{}, .moves = moves_};
  for (const Axis a : stage::kAllAxes) {
    (*memory.positions)[stage::index_of(a)] = axis(a).position(now);
    memory.lags[stage::index_of(a)] = axis(a).lag(now);
  }
  return memory;
}

}  // namespace gonio::sim
