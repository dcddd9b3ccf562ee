#pragma once

#include <cstddef>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "daemon/config/instrument.h"

namespace gonio::daemon {

/// The exposures that a detector is used with: shortest * 2^n, up to the longest that the detector and the plan's time
/// of a reading allow; never empty. Each of them has its dark. A radiometer has ranges instead, the largest first: each
/// a rung, and all readings as long.
[[nodiscard]] std::vector<Duration> exposure_ladder(const DetectorConfig& detector, Duration max_time);

/// The rungs of exposures that a plan states, each within one per cent of one: cameras round to their own clock.
/// Errors: InvalidInput (the exposure, and the rungs beside it).
[[nodiscard]] Result<std::vector<std::size_t>> rungs_of(const std::vector<Duration>& exposures,
                                                        const std::vector<Duration>& ladder);

}  // namespace gonio::daemon
