// What faults do to the bench: stage, axes and lamp. Those of the wires are done there.
#include <algorithm>

#include "sim/devices/instrument.h"

namespace gonio::sim {
namespace {

bool is_of_the_bench(FaultKind kind) {
  switch (kind) {
    case FaultKind::StagePowerCycle:
    case FaultKind::InterlockOpen:
    case FaultKind::EncoderJump:
    case FaultKind::MissedSteps:
    case FaultKind::LimitHit:
    case FaultKind::AxisBlocked:
    case FaultKind::LampStep:
    case FaultKind::LampOff:
    case FaultKind::MonitorDead:
    case FaultKind::MonitorStuck:
    case FaultKind::DrivePowerCycle:
      return true;
    default:
      return false;
  }
}

bool is_of_one_axis(FaultKind kind) {
  return traits(kind).parameters.has(FaultParameter::Axis);
}

Instant middle(Instant from, Instant to) {
  return from + (to - from) / 2;
}

}  // namespace

bool Instrument::arm(const PlannedFault& fault, Instant now) {
  const bool is_armed = faults_.arm(fault);
  advance_to(now);
  return is_armed;
}

void Instrument::end_fault(FaultKind kind, Instant now) {
  advance_to(now);
  faults_.end(kind);
  std::erase_if(agenda_, [kind](const Act& act) { return act.fault.kind == kind; });
  undo_fault(kind, now_);
}

void Instrument::put_on_agenda(const Act& act) {
  const auto later = [](Instant at, const Act& other) { return at < other.at; };
  agenda_.insert(std::upper_bound(agenda_.begin(), agenda_.end(), act.at, later), act);
}

std::optional<Instant> Instrument::next_act() const {
  std::optional<Instant> next;
  if (!agenda_.empty()) next = agenda_.front().at;
  if (const auto due_s = faults_.next_due_s()) {
    const Instant due = std::max(now_, power_up_ + scene_.wall(*due_s - memory_.scene_time_s));
    next = std::min(next.value_or(due), due);
  }
  return next;
}

void Instrument::act_on_faults(Instant now) {
  while (!agenda_.empty() && agenda_.front().at <= now) {
    const Act act = agenda_.front();
    agenda_.erase(agenda_.begin());
    if (act.is_end)
      undo_fault(act.fault.kind, now);
    else
      begin_fault(act.fault, now);
  }
  // A rounded instant may lie a moment before its scene time.
  constexpr double kRounding_s = 1e-6;
  const double due_s = scene_time_s(now) + kRounding_s * scene_.time_scale;
  while (const auto fault = faults_.take_due(due_s, now)) begin_fault(*fault, now);
}

void Instrument::note_motion(Instant now, std::optional<stage::Axis> of_drive) {
  const auto concerns = [&](const PlannedFault& fault) {
    if (!is_of_the_bench(fault.kind)) return false;
    if (!is_of_one_axis(fault.kind)) return stage_.is_moving(now);
    if (of_drive && *of_drive != fault.axis()) return false;
    const AxisModel& axis = stage_.axis(fault.axis());
    return axis.is_moving(now) && (axis.is_homed() || fault.kind != FaultKind::MissedSteps);
  };
  const auto fault = strike(FaultMoment::Move, now, concerns);
  if (!fault) return;
  Instant end = now;
  for (const stage::Axis axis : stage::kAllAxes) {
    if (!is_of_one_axis(fault->kind) || axis == fault->axis()) end = std::max(end, stage_.axis(axis).motion_end());
  }
  const bool is_from_the_start = fault->kind == FaultKind::MissedSteps;
  put_on_agenda({.at = is_from_the_start ? now : middle(now, end), .fault = *fault});
}

void Instrument::note_exposure(Instant open, Instant close) {
  const auto fault = strike(FaultMoment::Exposure, open, [](const PlannedFault& f) { return is_of_the_bench(f.kind); });
  if (fault) put_on_agenda({.at = middle(open, close), .fault = *fault});
}

void Instrument::begin_fault(const PlannedFault& fault, Instant now) {
  const double at_s = scene_time_s(now);
  switch (fault.kind) {
    case FaultKind::StagePowerCycle:
      reboot_stage(now);
      break;
    case FaultKind::InterlockOpen:
      stage_.set_interlock(true, now);
      break;
    case FaultKind::EncoderJump:
      stage_.slip_encoder(fault.axis(), fault.by());
      break;
    case FaultKind::MissedSteps:
      stage_.lose_steps(fault.axis(), fault.by(), now);
      break;
    case FaultKind::LimitHit:
      stage_.hit_limit(fault.axis(), now);
      break;
    case FaultKind::AxisBlocked:
      stage_.block_axis(fault.axis(), now);
      break;
    case FaultKind::DrivePowerCycle:
      stage_.power_cycle_axis(fault.axis(), now);
      break;
    case FaultKind::LampStep:
      lamp_faults_.step(at_s, fault.factor());
      break;
    case FaultKind::LampOff:
      lamp_faults_.step(at_s, 0.0);
      break;
    case FaultKind::MonitorDead:
      lamp_faults_.set_monitor(LampFaults::Monitor::Dead);
      break;
    case FaultKind::MonitorStuck:
      lamp_faults_.set_monitor(LampFaults::Monitor::Stuck);
      break;
    default:
      return;  // a wire's
  }
  if (!traits(fault.kind).lasts) return;
  if (const auto end = fault.end(now)) put_on_agenda({.at = *end, .fault = fault, .is_end = true});
}

void Instrument::undo_fault(FaultKind kind, Instant now) {
  switch (kind) {
    case FaultKind::InterlockOpen:
      return stage_.set_interlock(false, now);
    case FaultKind::AxisBlocked:
      for (const stage::Axis axis : stage::kAllAxes) stage_.free_axis(axis);
      return;
    case FaultKind::LampStep:
    case FaultKind::LampOff:
      return lamp_faults_.step(scene_time_s(now), 1.0);
    case FaultKind::MonitorDead:
    case FaultKind::MonitorStuck:
      return lamp_faults_.set_monitor(LampFaults::Monitor::Good);
    default:
      return;
  }
}

}  // namespace gonio::sim
