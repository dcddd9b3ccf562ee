#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/geometry.h"
#include "base/units.h"
#include "daemon/planner/time_experience.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {

/// One point of a plan, as it is materialised in the store. `index` counts the points in the order of the plan's text
/// after merging; `rank` is its place in the order of measurement (blocked points have the ranks after all others).
struct ScanPoint {
  std::int32_t index = 0;
  std::int32_t rank = 0;
  Geometry geometry;
  Wavelength wavelength;
  bool blocked = false;  ///< by the shadow of the detector's head: recorded, never visited, never filled in
  int repeat = 1;        ///< which of the times that the plan asks for this point
};

/// How many items so many points have: sample and reference, or the sample alone where the standard is read elsewhere.
[[nodiscard]] constexpr std::int64_t items_of(std::int64_t points, api::ReferenceMode mode) {
  return mode == api::ReferenceMode::SameGeometry ? 2 * points : points;
}

/// Time in which nothing moved, settled, took light or gave a frame, by what it waited for.
struct IdleTime {
  Duration commit{};    ///< the store: an exposure waits for the commit of the item before
  Duration wire{};      ///< what a move or an exposure took beyond its own: exchanges, looks that came late
  Duration device{};    ///< what was not asked for by the plan: homing, resets, moves back, tries that failed
  Duration hold{};      ///< holds
  Duration planning{};  ///< the daemon's own, between answers and requests; of old scans, what nobody told apart
  [[nodiscard]] Duration total() const { return commit + wire + device + hold + planning; }
};

/// Where the time of a scan goes, by the instrument's own numbers.
struct TimeParts {
  Duration move{};
  Duration settle{};
  Duration expose{};
  Duration read{};
  IdleTime idle;
  [[nodiscard]] Duration total() const { return move + settle + expose + read + idle.total(); }
};

/// What was said of a scan's time before it began.
struct PredictedTime {
  Duration total{};
  double u_s = 0.0;        ///< standard uncertainty
  Learned motion;          ///< that it was made with
  std::int64_t scans = 0;  ///< finished ones that it rests on
};

/// What a plan's budget left of it. Counts are of points that are not blocked.
struct BudgetChoice {
  Duration allowed{};
  Duration wished{};            ///< what the whole plan would take
  std::int64_t directions = 0;  ///< of the plan
  std::int64_t kept = 0;        ///< of them
  std::int64_t repeats = 0;     ///< of the plan, beyond the first time of each direction
  std::int64_t kept_repeats = 0;
  double target_snr = 0.0;  ///< of a reading, chosen
  Angle widest_gap;         ///< from a detector's direction that was left out to the nearest kept one
};

/// What a dry run says, and what the run then does.
struct PlannedScan {
  int planner_version = 0;
  std::vector<ScanPoint> points;              ///< by index
  std::vector<std::int32_t> order;            ///< indices of the points that are not blocked, by rank
  std::int64_t asked = 0;                     ///< combinations in the plan's text
  std::int64_t merged = 0;                    ///< the same directions once more, left out
  std::int64_t out_of_reach = 0;              ///< of cones, beyond the axes' limits: left out
  std::vector<std::int32_t> without_partner;  ///< of reciprocal pairs: points whose partner the arms do not reach
  std::int64_t blocked = 0;
  std::int64_t items = 0;              ///< of the points that are not blocked: items_of
  std::int64_t anchors = 0;            ///< of the points, those added because the standard is visited there
  TimeParts estimate;                  ///< visits included
  double u_estimate_s = 0.0;           ///< standard uncertainty of it
  TimeExperience experience;           ///< what the estimate rests on
  std::optional<BudgetChoice> budget;  ///< of a plan that has one
};

/// None of a scan whose time nobody estimated.
[[nodiscard]] inline std::optional<PredictedTime> prediction_of(const PlannedScan& planned) {
  const Duration total = planned.estimate.total();
  if (total == Duration::zero()) return std::nullopt;
  return PredictedTime{total, planned.u_estimate_s, planned.experience.motion, planned.experience.scans};
}

}  // namespace gonio::daemon
