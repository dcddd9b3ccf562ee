#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "daemon/config/instrument.h"
#include "daemon/planner/planned_scan.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {

/// The lists of a product plan, as places in a grid: theta_i, phi_i, theta_r, phi_r, wavelength.
inline constexpr std::size_t kPlanListCount = 5;
using GridPlace = std::array<std::uint32_t, kPlanListCount>;

/// The indices of the points that are not blocked, in the order of measurement. `places[index]` is a point's place in
/// the grid of `sizes`. Deterministic, `Random` by the plan's seed.
[[nodiscard]] std::vector<std::int32_t> measuring_order(const api::Plan& plan, const Instrument& instrument,
                                                        const std::vector<ScanPoint>& points,
                                                        const std::vector<GridPlace>& places, const GridPlace& sizes);

}  // namespace gonio::daemon
