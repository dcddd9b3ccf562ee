#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <tuple>
#include <vector>

#include "calibration/direction_slopes.h"

namespace gonio::calibration {

/// How steeply f_r changes from a point to those about it that stand on no line with it: what a point without a
/// neighbour along either theta leans on. A secant joins two points of the same light and incidence, over the arc
/// between their scattered directions; of ln f where both values stand clear of zero, for on the flank of a lobe f
/// changes by its multiples. What noise alone makes of a difference is taken off. Nothing is computed before the first
/// point asks. Threads: any.
class NearbySecants {
 public:
  /// Both outlive it; `ordinates[n]` is of points[n].
  NearbySecants(std::span<const SlopePoint> points, std::span<const SlopeOrdinate> ordinates, bool isotropic)
      : points_(points), ordinates_(ordinates), isotropic_(isotropic) {}

  /// The steepest secant from points[n] to the four nearest points within 45 deg of arc: sr^-1 per radian, >= 0; 0
  /// where there are none.
  [[nodiscard]] double steepest(std::size_t n) const;

 private:
  /// A point among those of its light and incidence, which stand together by growing theta_r.
  struct Place {
    std::int64_t light = 0;
    std::int32_t theta_i = 0;
    std::int32_t phi_i = 0;
    double theta_r = 0.0;
    std::uint32_t point = 0;
    [[nodiscard]] auto order() const { return std::tuple(light, theta_i, phi_i, theta_r, point); }
    [[nodiscard]] bool has_light_of(const Place& other) const {
      return light == other.light && theta_i == other.theta_i && phi_i == other.phi_i;
    }
  };
  [[nodiscard]] Place place_of(std::size_t n) const;
  void sort() const;
  [[nodiscard]] double arc(std::size_t a, std::size_t b) const;
  [[nodiscard]] double secant(std::size_t n, std::size_t other, double arc) const;

  std::span<const SlopePoint> points_;
  std::span<const SlopeOrdinate> ordinates_;
  bool isotropic_;
  mutable std::once_flag sorted_;
  mutable std::vector<Place> places_;
};

}  // namespace gonio::calibration
