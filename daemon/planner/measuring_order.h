#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "daemon/config/instrument.h"
#include "daemon/planner/planned_scan.h"
#include "daemon/planner/step_price.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {

/// The indices of the points that are not blocked, in the order of measurement, and what it takes.
struct MeasuringOrder {
  std::vector<std::int32_t> order;
  TimeParts time;
};

/// The order by the plan's strategy. Fastest: of a searched order and the best boustrophedon the one that the estimate
/// finds sooner; so never slower than the boustrophedon. Random: by the plan's seed. Deterministic. Errors: Blocked (no
/// order was found in which the arms can come to each point from the one before; the place on the path).
[[nodiscard]] Result<MeasuringOrder> measuring_order(const api::Plan& plan, const Instrument& instrument,
                                                     std::span<const ScanPoint> points,
                                                     const TimeExperience& experience = {});

/// The same without the search: the best boustrophedon stands for fastest. For plans that are tried out.
[[nodiscard]] Result<MeasuringOrder> quick_order(const api::Plan& plan, const Instrument& instrument,
                                                 std::span<const ScanPoint> points, const TimeExperience& experience);

/// The best boustrophedon alone: what others are compared with.
[[nodiscard]] std::vector<std::int32_t> snaked_order(const Instrument& instrument, std::span<const ScanPoint> points);

/// Where the axes stand when the points of `order` are walked from home, home first; each by `axis_targets` from the
/// one before. Carriage: at home. Every direction must be within the axes' limits (asserted).
[[nodiscard]] std::vector<Place> places_along(const Instrument& instrument, std::span<const ScanPoint> points,
                                              std::span<const std::int32_t> order);

}  // namespace gonio::daemon
