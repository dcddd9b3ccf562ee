#pragma once

#include <cstdint>
#include <optional>

#include "base/clock.h"

namespace gonio::daemon {

/// Which holds end by themselves, and after how long without their cause. Nothing: the operator resumes.
struct HoldRules {
  std::optional<Duration> lamp;  ///< its monitor has been in the band for so long
  std::optional<Duration> door;  ///< the interlock has been closed for so long
  std::optional<Duration>
      device;                    ///< the stage has answered without a fault for so long; a detector is tried again then
  std::optional<Duration> disk;  ///< there has been room for so long
  std::int64_t disk_least_bytes = 100 * 1024 * 1024;  ///< free on the store's disk; below it scans hold
  std::int64_t disk_again_bytes = 125 * 1024 * 1024;  ///< and from here on there is room again
};

/// When a lamp counts as warm: its monitor changes by less than `slope_per_s` (relative) over `over`.
struct LampWarmUp {
  double slope_per_s = 0.0;
  Duration over{};
  Duration at_most{};  ///< waited so long in vain: the scan holds
};

}  // namespace gonio::daemon
