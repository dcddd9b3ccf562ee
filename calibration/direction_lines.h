#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/large_array.h"
#include "calibration/direction_slopes.h"

namespace gonio::calibration {

/// What tells the lines of a point apart, in whole thousandths of a degree.
struct DirectionKey {
  std::int64_t light = 0;  ///< wavelength and polarisation
  std::int32_t theta_i = 0;
  std::int32_t theta_r = 0;
  std::int32_t phi_i = 0;
  std::int32_t dphi = 0;  ///< in (-180, 180 deg], of an isotropic sample its size
};
[[nodiscard]] DirectionKey direction_key(const SlopePoint& point, bool isotropic);

/// One point as it stands on a line: `sign` says whether its own angle grows along the line or against it.
struct LineStop {
  static constexpr std::uint32_t kNobody = ~std::uint32_t{0};  ///< of the stops at infinity, between two lines

  double coordinate = 0.0;  ///< rad
  std::uint32_t point = kNobody;
  std::int8_t sign = 1;
  bool is_image = false;  ///< of a point that stands elsewhere on the same line itself
};

/// Nothing is read further away: a polynomial over more than 45 deg says nothing of a slope. rad
inline constexpr double kFarthestStop = 0.7853981633974483;

/// All points of a scan, sorted into the lines along one angle: what may be differentiated. Rules: direction_slopes.h.
/// Lines stand one after the other, ascending by coordinate, each between two stops at infinity, so that who walks from
/// a stop to its neighbours needs no other end. Threads: any.
class DirectionLines {
 public:
  DirectionLines(std::span<const SlopePoint> points, std::span<const DirectionKey> keys, bool isotropic,
                 DirectionAxis axis);

  /// Where point n stands itself. Whoever asks for one point after the other finds the stop already called from memory:
  /// on two of the axes neighbours in the plan stand on lines far from each other.
  [[nodiscard]] const LineStop& stop_of(std::size_t n) const {
    constexpr std::size_t kAhead = 8;
    if (n + kAhead < place_.size()) {
      const std::uint32_t soon = place_[n + kAhead];
      constexpr std::uint32_t kNeighbours = 2;  // on either side: they may lie across a line of memory
      __builtin_prefetch(&stops_[soon - std::min(soon, kNeighbours)]);
      __builtin_prefetch(stops_.data() + std::min<std::size_t>(soon + kNeighbours, stops_.size() - 1));
    }
    return stops_[place_[n]];
  }

 private:
  LargeArray<LineStop> stops_;
  LargeArray<std::uint32_t> place_;  ///< [point], in `stops_`
};

/// An angle as plans name it: to 0.001 deg.
[[nodiscard]] std::int64_t plan_key(Angle a);
/// phi_r - phi_i in (-180, 180 deg], of an isotropic sample its size.
[[nodiscard]] Angle azimuth_between(const Geometry& g, bool isotropic);

}  // namespace gonio::calibration
