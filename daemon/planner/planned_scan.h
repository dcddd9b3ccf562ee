#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/geometry.h"
#include "base/units.h"

namespace gonio::daemon {

/// One point of a plan, as it is materialised in the store. `index` counts the points in the order of the plan's text
/// after merging; `rank` is its place in the order of measurement (blocked points have the ranks after all others).
struct ScanPoint {
  std::int32_t index = 0;
  std::int32_t rank = 0;
  Geometry geometry;
  Wavelength wavelength;
  bool blocked = false;  ///< by the shadow of the detector's head: recorded, never visited, never filled in
};

/// Where the time of a scan goes, by the instrument's own numbers.
struct TimeParts {
  Duration move{};
  Duration settle{};
  Duration expose{};
  Duration read{};
  Duration idle{};
  [[nodiscard]] Duration total() const { return move + settle + expose + read + idle; }
};

/// What a dry run says, and what the run then does.
struct PlannedScan {
  int planner_version = 0;
  std::vector<ScanPoint> points;    ///< by index
  std::vector<std::int32_t> order;  ///< indices of the points that are not blocked, by rank
  std::int64_t asked = 0;           ///< combinations in the plan's text
  std::int64_t merged = 0;          ///< duplicates by phi at theta = 0, left out
  std::int64_t blocked = 0;
  std::int64_t items = 0;  ///< sample and reference, of the points that are not blocked
  TimeParts estimate;      ///< visits included
};

}  // namespace gonio::daemon
