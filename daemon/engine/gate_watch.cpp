#include "daemon/engine/gate_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/motion/motion_watch.h"

namespace gonio::daemon {
namespace {

constexpr Duration kShortestPoll = std::chrono::milliseconds(1);
constexpr Duration kLongestPoll = std::chrono::milliseconds(20);
// After the expected end the looks follow as closely as it is late: a device whose lag is short is not kept waiting,
// one whose lag is long is not pestered.
constexpr Duration kClosest = std::chrono::microseconds(100);
constexpr int kPartOfLag = 4;

}  // namespace

GateWatch::GateWatch(const drivers::StageConfig& config, const WatchGate& request,
                     std::optional<std::uint32_t> boot_counter, Instant now)
    : config_(config),
      request_(request),
      boot_counter_(boot_counter),
      started_(now),
      deadline_(now + seconds(in_seconds(request.expected) * config.deadline_factor) + config.deadline_margin),
      poll_(std::clamp<Duration>(request.expected / 8, kShortestPoll, kLongestPoll)) {}

Error GateWatch::error(ErrorCode code, std::string seen, std::string limit) const {
  return {.code = code,
          .device = "stage",
          .tried = fmt::format("watch exposure {}", request_.after + 1),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

Result<drivers::MotionProgress> GateWatch::look(const drivers::StageState& seen, Instant now) {
  GONIO_TRY(check_stage(seen));
  const drivers::GateRecord& gate = seen.gate;
  const std::uint32_t counted = gate.count - request_.after;  // modulo 2^32, as the counter runs
  if (counted == 1 && !gate.open) {
    GONIO_TRY(check_held(gate));
    return drivers::MotionProgress{true, now};
  }
  if (counted > 1 && counted <= UINT32_MAX / 2) {
    return failure(error(ErrorCode::StaleData, fmt::format("{} exposures counted", counted), "one"));
  }
  const Duration poll = std::clamp<Duration>((now - first_look()) / kPartOfLag, kClosest, poll_);
  if (now < deadline_) return drivers::MotionProgress{false, std::min(now + poll, deadline_)};
  return failure(error(ErrorCode::TimedOut,
                       fmt::format("gate count {}, gate {}", gate.count, gate.open ? "still open" : "closed"),
                       fmt::format("counted and closed within {:.3f} s", in_seconds(deadline_ - started_))));
}

Result<void> GateWatch::check_stage(const drivers::StageState& seen) const {
  if (boot_counter_ && seen.boot_counter != *boot_counter_) {
    return failure(error(ErrorCode::PositionLost, fmt::format("boot counter {}", seen.boot_counter),
                         fmt::format("it was {} before", *boot_counter_)));
  }
  if (const std::string faults = drivers::fault_text(seen); !faults.empty()) {
    return failure(error(ErrorCode::DeviceFault, faults));
  }
  return {};
}

Result<void> GateWatch::check_held(const drivers::GateRecord& gate) const {
  for (const stage::Axis axis : stage::kAllAxes) {
    const std::size_t i = stage::index_of(axis);
    const auto& held = request_.held[i];
    if (!held) continue;
    const double window = config_.axis(axis).window;
    for (const auto& [counts, when] : {std::pair{gate.open_counts[i], "began"}, {gate.close_counts[i], "ended"}}) {
      const double position = drivers::position_of(config_, axis, counts);
      if (std::abs(position - *held) <= window) continue;
      return failure(error(
          ErrorCode::OutOfTolerance,
          fmt::format("{} at {:.4f} {} when it {}", stage::axis_name(axis), position, stage::axis_unit(axis), when),
          fmt::format("{:.4f} +- {:.4f} {}", *held, window, stage::axis_unit(axis))));
    }
  }
  return {};
}

}  // namespace gonio::daemon
