#include "daemon/planner/visit_place.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace gonio::daemon {

std::int32_t visit_point(std::span<const ScanPoint> points) {
  const auto far_and_late = [](const ScanPoint& point) {
    const double away =
        std::abs(in_degrees(point.geometry.theta_i)) + std::abs(in_degrees(point.geometry.theta_r) - 45);
    return std::tuple(point.blocked, std::llround(away * 1e6), point.rank);
  };
  const auto best = std::ranges::min_element(points, {}, far_and_late);
  return best == points.end() ? 0 : best->index;
}

double visit_snr(double drift_limit) {
  return 4.0 * std::sqrt(2.0) / drift_limit;
}

}  // namespace gonio::daemon
