#pragma once

#include <cstdint>
#include <vector>

#include "base/geometry.h"
#include "daemon/planner/planned_scan.h"

namespace gonio::daemon {

/// Whether the standard, which is isotropic, gives the same reading here as at the anchor.
[[nodiscard]] bool is_at_anchor(const Geometry& g, const Geometry& anchor);

/// The points at which the standard is visited in anchor mode: the first one of each wavelength that is not blocked, in
/// the order of the points.
[[nodiscard]] std::vector<std::int32_t> anchor_points(const std::vector<ScanPoint>& points, const Geometry& anchor);

}  // namespace gonio::daemon
