#include "sim/faults/fault_desk.h"

#include <algorithm>

namespace gonio::sim {
namespace {

std::size_t index_of(FaultKind kind) {
  return static_cast<std::size_t>(kind);
}

}  // namespace

bool FaultDesk::arm(const PlannedFault& fault) {
  if (armed_.size() >= kMostArmed) return false;
  armed_.push_back({.fault = fault, .comes_at_once = traits(fault.kind).may_come_at_once && !fault.after});
  return true;
}

void FaultDesk::end(FaultKind kind) {
  std::erase_if(armed_, [kind](const Armed& armed) { return armed.fault.kind == kind; });
  standing_[index_of(kind)].reset();
}

std::optional<PlannedFault> FaultDesk::take_due(double scene_s, Instant now) {
  const auto due = std::ranges::find_if(
      armed_, [scene_s](const Armed& armed) { return armed.comes_at_once && scene_s >= armed.fault.at_s; });
  if (due == armed_.end()) return std::nullopt;
  const PlannedFault fault = due->fault;
  fire(*due, now);
  forget_spent();
  return fault;
}

std::optional<double> FaultDesk::next_due_s() const {
  std::optional<double> next;
  for (const Armed& armed : armed_) {
    if (armed.comes_at_once) next = std::min(next.value_or(armed.fault.at_s), armed.fault.at_s);
  }
  return next;
}

const PlannedFault* FaultDesk::active(FaultKind kind, Instant now) const {
  const auto& standing = standing_[index_of(kind)];
  if (!standing || (standing->until && now >= *standing->until)) return nullptr;
  return &standing->fault;
}

FaultCount FaultDesk::count(FaultKind kind, Instant now) const {
  FaultCount count{.fired = fired_[index_of(kind)], .is_active = active(kind, now) != nullptr};
  for (const Armed& armed : armed_) {
    if (armed.fault.kind == kind) count.armed += armed.fault.times - armed.fired;
  }
  return count;
}

void FaultDesk::fire(Armed& armed, Instant now) {
  const std::size_t kind = index_of(armed.fault.kind);
  ++armed.fired;
  ++fired_[kind];
  if (traits(armed.fault.kind).lasts) standing_[kind] = Standing{armed.fault, armed.fault.end(now)};
}

void FaultDesk::forget_spent() {
  std::erase_if(armed_, [](const Armed& armed) { return armed.fired >= armed.fault.times; });
}

}  // namespace gonio::sim
