#include "daemon/sequencer/held_window.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "drivers/motion/motion_watch.h"

namespace gonio::daemon {
namespace {

Error window_error(ErrorCode code, std::string_view when, std::string seen, std::string limit) {
  return {.code = code,
          .device = "stage",
          .tried = fmt::format("hold still, looked at {} the exposure", when),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

}  // namespace

Result<void> check_held(const Instrument& instrument, const drivers::MotionTarget& held,
                        const drivers::StageState& seen, const char* when) {
  if (const std::string faults = drivers::fault_text(seen); !faults.empty()) {
    return failure(window_error(ErrorCode::DeviceFault, when, faults, {}));
  }
  if (!seen.homed) return failure(window_error(ErrorCode::PositionLost, when, "the home is gone", "homed"));
  if (seen.moving) return failure(window_error(ErrorCode::OutOfTolerance, when, "it moves", "at rest"));
  for (const stage::Axis axis : stage::kAllAxes) {
    const std::size_t i = stage::index_of(axis);
    if (!held[i]) continue;
    const double window = instrument.stage.axis(axis).window;
    const double position = seen.axes[i].position;
    if (std::abs(position - *held[i]) <= window) continue;
    return failure(
        window_error(ErrorCode::OutOfTolerance, when,
                     fmt::format("{} at {:.4f} {}", stage::axis_name(axis), position, stage::axis_unit(axis)),
                     fmt::format("{:.4f} +- {:.4f} {}", *held[i], window, stage::axis_unit(axis))));
  }
  return {};
}

Result<drivers::GateRecord> window_record(const drivers::StageState& before, const drivers::StageState& after) {
  if (before.boot_counter != after.boot_counter) {
    return failure(window_error(ErrorCode::PositionLost, "after", fmt::format("boot counter {}", after.boot_counter),
                                fmt::format("it was {} before", before.boot_counter)));
  }
  drivers::GateRecord record;
  for (const stage::Axis axis : stage::kAllAxes) {
    const std::size_t i = stage::index_of(axis);
    record.open_counts[i] = before.axes[i].counts;
    record.close_counts[i] = after.axes[i].counts;
  }
  record.monitor_mean = 0.5 * (before.monitor + after.monitor);
  record.monitor_se = 0.5 * std::abs(after.monitor - before.monitor);
  record.monitor_samples = 2;
  return record;
}

}  // namespace gonio::daemon
