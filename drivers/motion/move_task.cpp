#include "drivers/motion/move_task.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "drivers/motion/leg_axes.h"

namespace gonio::drivers {
namespace {

constexpr Duration kShortestPoll = std::chrono::milliseconds(1);
constexpr Duration kLongestPoll = std::chrono::milliseconds(20);
// After the predicted arrival the looks follow as closely as it is late: a stage whose lag is short is not kept
// waiting, one whose lag is long is not pestered.
constexpr Duration kClosest = std::chrono::microseconds(100);
constexpr int kPartOfLag = 4;

}  // namespace

std::string motion_text(const MotionTarget& target) {
  std::string text;
  for (const stage::Axis axis : stage::kAllAxes) {
    const auto& wanted = target[stage::index_of(axis)];
    if (!wanted) continue;
    text += fmt::format("{}{} to {:.3f} {}", text.empty() ? "move " : ", ", stage::axis_name(axis), *wanted,
                        stage::axis_unit(axis));
  }
  return text.empty() ? "move nothing" : text;
}

MoveTask::MoveTask(const StageConfig& config, const StageState& before, const MotionTarget& target, MotionToken token,
                   Epoch epoch, Instant now, Ending ending)
    : axes_(config.axes), target_(target), watch_(before, token, epoch, motion_text(target)), started_(now) {
  poll_ = kLongestPoll;
  travel_ = leg_time(config, positions_of(before), target);
  for (const stage::Axis axis : stage::kAllAxes) {
    const std::size_t i = stage::index_of(axis);
    if (!target_[i]) continue;
    if (ending == Ending::Rest) axes_[i].settle = Duration::zero();
    const AxisConfig& how = axes_[i];
    settle_ = std::max(settle_, how.settle);
    poll_ = std::min(poll_, how.settle / 4);
  }
  poll_ = std::max(poll_, kShortestPoll);
  deadline_ = now + seconds(in_seconds(travel_ + settle_) * config.deadline_factor) + config.deadline_margin;
}

Result<MotionProgress> MoveTask::look(const StageState& seen, Instant now) {
  const Result<bool> accepted = watch_.look(seen);
  if (!accepted) return failure(accepted.error());
  if (*accepted && !accepted_at_) accepted_at_ = now;
  GONIO_TRY(check_homed(seen));
  const std::optional<Instant> settled = *accepted ? settled_at(seen, now) : std::nullopt;
  if (settled && *settled <= now) return MotionProgress{true, now};
  if (is_overdue(settled, now)) return failure(late(seen, *accepted));
  const Instant arrival = predicted_arrival();
  const bool is_due = !settled && accepted_at_ && now >= arrival;
  Instant next = now + (is_due ? std::clamp<Duration>((now - arrival) / kPartOfLag, kClosest, poll_) : poll_);
  if (settled) next = std::min(next, *settled);
  if (accepted_at_ && !settled && now < arrival) next = std::min(now + kLongestUnseen, arrival);
  return MotionProgress{false, std::min(next, std::max(deadline_, now + kShortestPoll))};
}

// A look that comes late because this program was slow still counts: what it finds in place may settle once.
bool MoveTask::is_overdue(std::optional<Instant> settled, Instant now) {
  if (now < deadline_) return false;
  if (!overtime_) overtime_ = now;
  return !settled || *settled > *overtime_ + settle_;
}

bool MoveTask::is_in_place(stage::Axis axis, const StageState& seen) const {
  const std::size_t i = stage::index_of(axis);
  return !seen.axes[i].moving && std::abs(seen.axes[i].position - *target_[i]) <= axes_[i].window;
}

// When all axes will have settled if they stay where they are; nothing while one of them is not in place.
std::optional<Instant> MoveTask::settled_at(const StageState& seen, Instant now) {
  std::optional<Instant> all = now;
  for (const stage::Axis axis : stage::kAllAxes) {
    const std::size_t i = stage::index_of(axis);
    if (!target_[i]) continue;
    if (!is_in_place(axis, seen)) {
      in_place_since_[i].reset();
      all.reset();
      continue;
    }
    if (!in_place_since_[i]) in_place_since_[i] = now;
    if (all) all = std::max(*all, *in_place_since_[i] + axes_[i].settle);
  }
  return all;
}

Result<void> MoveTask::check_homed(const StageState& seen) const {
  for (const stage::Axis axis : stage::kAllAxes) {
    const std::size_t i = stage::index_of(axis);
    if (!target_[i] || seen.axes[i].homed) continue;
    return failure(watch_.error(ErrorCode::NotHomed, fmt::format("{} is not homed", stage::axis_name(axis))));
  }
  return {};
}

Error MoveTask::late(const StageState& seen, bool accepted) const {
  const double allowed = in_seconds(deadline_ - started_);
  if (!accepted) {
    return watch_.error(ErrorCode::MotionLate, "the stage has neither accepted nor refused it",
                        fmt::format("within {:.3f} s", allowed));
  }
  for (const stage::Axis axis : stage::kAllAxes) {
    const std::size_t i = stage::index_of(axis);
    if (!target_[i] || is_in_place(axis, seen)) continue;
    const AxisState& now = seen.axes[i];
    return watch_.error(ErrorCode::MotionLate,
                        fmt::format("{} is at {:.4f} {} and {}", stage::axis_name(axis), now.position,
                                    stage::axis_unit(axis), now.moving ? "still moving" : "at rest"),
                        fmt::format("{:.4f} +- {:.4f} {} within {:.3f} s", *target_[i], axes_[i].window,
                                    stage::axis_unit(axis), allowed));
  }
  return watch_.error(ErrorCode::MotionLate, "every axis is in its window but has not stayed there",
                      fmt::format("settled within {:.3f} s", allowed));
}

}  // namespace gonio::drivers
