#include "drivers/motion/motion_watch.h"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace gonio::drivers {
namespace {

std::string_view fault_name(std::uint16_t fault) {
  constexpr std::array<std::string_view, 5> kNames{"none", "following error", "drive fault", "limit switch",
                                                   "encoder fault"};
  return fault < kNames.size() ? kNames[fault] : "unknown to this program";
}

ErrorCode code_of(stage::Refusal refusal) {
  switch (refusal) {
    case stage::Refusal::EpochTooOld:
      return ErrorCode::StaleEpoch;
    case stage::Refusal::Halted:
      return ErrorCode::Stopped;
    case stage::Refusal::HeartbeatTripped:
      return ErrorCode::HeartbeatTripped;
    case stage::Refusal::NotHomed:
      return ErrorCode::NotHomed;
    case stage::Refusal::Fault:
      return ErrorCode::DeviceFault;
    case stage::Refusal::InterlockOpen:
      return ErrorCode::Interlock;
    default:
      return ErrorCode::DeviceRefused;
  }
}

}  // namespace

std::string fault_text(const StageState& seen) {
  std::string text;
  if (seen.fault != 0) text = fmt::format("fault {} ({})", seen.fault, fault_name(seen.fault));
  for (const stage::Axis axis : stage::kAllAxes) {
    const std::uint16_t fault = seen.axes[stage::index_of(axis)].fault;
    if (fault == 0) continue;
    text += fmt::format("{}axis {} fault {} ({})", text.empty() ? "" : ", ", stage::axis_name(axis), fault,
                        fault_name(fault));
    if (const std::uint16_t alarm = seen.axes[stage::index_of(axis)].alarm; alarm != 0) {
      text += fmt::format(", alarm {:#06x}", alarm);
    }
  }
  return text;
}

MotionWatch::MotionWatch(const StageState& before, MotionToken token, Epoch epoch, std::string tried)
    : boot_counter_(before.boot_counter),
      stop_count_(before.stop_count),
      accepted_before_(before.accepted_token),
      token_(token),
      epoch_(epoch),
      tried_(std::move(tried)) {}

Error MotionWatch::error(ErrorCode code, std::string seen, std::string limit) const {
  return {.code = code, .device = "stage", .tried = tried_, .seen = std::move(seen), .limit = std::move(limit)};
}

Result<bool> MotionWatch::look(const StageState& seen) {
  GONIO_TRY(check_power(seen));
  GONIO_TRY(check_refusal(seen));
  GONIO_TRY(check_stops(seen));
  if (seen.accepted_token == token_) {
    accepted_ = true;
    return true;
  }
  if (accepted_ || seen.accepted_token != accepted_before_) {
    return failure(error(ErrorCode::ControlLost, fmt::format("the stage obeys command {}", seen.accepted_token),
                         fmt::format("ours is {}", token_)));
  }
  return false;
}

Result<void> MotionWatch::check_power(const StageState& seen) const {
  if (seen.boot_counter == boot_counter_) return {};
  return failure(error(ErrorCode::PositionLost, fmt::format("boot counter {}", seen.boot_counter),
                       fmt::format("it was {} when the command was given", boot_counter_)));
}

Result<void> MotionWatch::check_refusal(const StageState& seen) const {
  // A command that was written twice after a lost reply is accepted once and refused once: accepted is what counts.
  if (seen.refused_token != token_ || seen.accepted_token == token_) return {};
  std::string why = fmt::format("refused: {}", stage::refusal_name(seen.refusal));
  std::string limit;
  if (seen.refusal == stage::Refusal::EpochTooOld) {
    why += fmt::format(", epoch {}", epoch_);
    limit = fmt::format("at least {}", seen.epoch);
  }
  return failure(error(code_of(seen.refusal), std::move(why), std::move(limit)));
}

Result<void> MotionWatch::check_stops(const StageState& seen) const {
  if (const std::string faults = fault_text(seen); !faults.empty())
    return failure(error(ErrorCode::DeviceFault, faults));
  if (seen.interlock_open) return failure(error(ErrorCode::Interlock, "the interlock is open"));
  if (seen.heartbeat_tripped) {
    return failure(error(ErrorCode::HeartbeatTripped, "the stage has not heard from us and stopped"));
  }
  if (seen.halted) return failure(error(ErrorCode::Stopped, "the stage is halted"));
  if (seen.stop_count != stop_count_) {
    return failure(error(ErrorCode::Stopped, fmt::format("stop count {}", seen.stop_count),
                         fmt::format("it was {} when the command was given", stop_count_)));
  }
  return {};
}

}  // namespace gonio::drivers
