#include "daemon/planner/anchor.h"

#include <algorithm>

namespace gonio::daemon {

bool is_at_anchor(const Geometry& g, const Geometry& anchor) {
  constexpr Angle kWithin = degrees(1e-3);
  constexpr bool kIsotropic = true;
  return same_geometry(g, anchor, kIsotropic, kWithin);
}

std::vector<std::int32_t> anchor_points(const std::vector<ScanPoint>& points, const Geometry& anchor) {
  std::vector<std::int32_t> found;
  for (const ScanPoint& point : points) {
    if (point.blocked || !is_at_anchor(point.geometry, anchor)) continue;
    const bool is_known = std::any_of(found.begin(), found.end(), [&](std::int32_t one) {
      return points[static_cast<std::size_t>(one)].wavelength == point.wavelength;
    });
    if (!is_known) found.push_back(point.index);
  }
  return found;
}

}  // namespace gonio::daemon
