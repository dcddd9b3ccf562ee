#include "drivers/motion/shutter_task.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace gonio::drivers {
namespace {

constexpr Duration kShutterPoll = std::chrono::milliseconds(2);

std::string_view state_name(stage::ShutterState state) {
  constexpr std::array<std::string_view, 3> kNames{"closed", "open", "moving"};
  return kNames[static_cast<std::size_t>(state)];
}

stage::ShutterState state_of(bool open) {
  return open ? stage::ShutterState::Open : stage::ShutterState::Closed;
}

}  // namespace

ShutterTask::ShutterTask(const StageConfig& config, const StageState& before, bool source_open, bool detector_open,
                         Instant now)
    : boot_counter_(before.boot_counter),
      source_(state_of(source_open)),
      detector_(state_of(detector_open)),
      started_(now),
      deadline_(now + config.shutter_time) {}

Result<MotionProgress> ShutterTask::look(const StageState& seen, Instant now) {
  const std::string tried =
      fmt::format("set the source shutter {}, the detector shutter {}", state_name(source_), state_name(detector_));
  if (seen.boot_counter != boot_counter_) {
    return failure({.code = ErrorCode::PositionLost,
                    .device = "stage",
                    .tried = tried,
                    .seen = fmt::format("boot counter {}", seen.boot_counter),
                    .limit = fmt::format("it was {} when the command was given", boot_counter_)});
  }
  if (seen.source_shutter == source_ && seen.detector_shutter == detector_) return MotionProgress{true, now};
  if (now < deadline_) return MotionProgress{false, std::min(now + kShutterPoll, deadline_)};
  return failure({.code = ErrorCode::MotionLate,
                  .device = "stage",
                  .tried = tried,
                  .seen = fmt::format("source shutter {}, detector shutter {}", state_name(seen.source_shutter),
                                      state_name(seen.detector_shutter)),
                  .limit = fmt::format("within {:.3f} s", in_seconds(deadline_ - started_))});
}

}  // namespace gonio::drivers
