#pragma once

#include <cstdint>
#include <span>

#include "daemon/planner/planned_scan.h"

namespace gonio::daemon {

/// Where a scan's lit visits are made: the point nearest to 0/45 (theta_i/theta_r) of those not blocked, where the
/// standard's shape is known best and no angle's error weighs much; of several the first that is measured.
[[nodiscard]] std::int32_t visit_point(std::span<const ScanPoint> points);

/// What a visit must reach, so that its noise does not pass for a drift: four standard deviations of a difference of
/// two visits are one limit.
[[nodiscard]] double visit_snr(double drift_limit);

}  // namespace gonio::daemon
