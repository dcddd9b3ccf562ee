#pragma once

#include "base/clock.h"
#include "daemon/config/instrument.h"
#include "daemon/planner/planned_scan.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {

/// How good the order of a planned scan is. `walk` and `bound` are of one pass through the points by the price of steps
/// alone (step_price.h: mean of there and back, nothing in the way), the way from home half. No walk is below the
/// bound: up to `kMostHeldKarp` places that of Held and Karp (1970, 1971), beyond half the sum of the two cheapest
/// steps at each place.
struct OrderReport {
  Duration walk{};
  Duration bound{};
  bool is_held_karp = false;
  Duration as_written{};  ///< of the whole scan, as its estimate; zero: the arms cannot walk it
  Duration snaked{};      ///< likewise, of the best boustrophedon
};
inline constexpr std::size_t kMostHeldKarp = 1000;

/// For the dry run only: takes as long as the planning itself.
[[nodiscard]] OrderReport judge_order(const api::Plan& plan, const Instrument& instrument, const PlannedScan& planned);

}  // namespace gonio::daemon
