#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "calibration/direction_slopes.h"

namespace gonio::calibration {

/// One point as it stands on a line: `sign` says whether its own angle grows along the line or against it.
struct LineStop {
  double coordinate = 0.0;  ///< rad
  std::uint32_t point = 0;
  float sign = 1.0F;
  bool is_image = false;  ///< of a point that stands elsewhere on the same line itself
};

/// All points of a scan, sorted into the lines along one angle: what may be differentiated. Rules: direction_slopes.h.
class DirectionLines {
 public:
  DirectionLines(std::span<const SlopePoint> points, bool isotropic, DirectionAxis axis);

  [[nodiscard]] std::size_t size() const { return first_.empty() ? 0 : first_.size() - 1; }
  /// Ascending by coordinate.
  [[nodiscard]] std::span<const LineStop> line(std::size_t n) const {
    return std::span(stops_).subspan(first_[n], first_[n + 1] - first_[n]);
  }

 private:
  std::vector<LineStop> stops_;
  std::vector<std::size_t> first_;  ///< [size() + 1]
};

/// An angle as plans name it: to 0.001 deg.
[[nodiscard]] std::int64_t plan_key(Angle a);
/// phi_r - phi_i in (-180, 180 deg], of an isotropic sample its size.
[[nodiscard]] Angle azimuth_between(const Geometry& g, bool isotropic);

}  // namespace gonio::calibration
