#pragma once

#include <cstddef>

#include "reflectance/integral/polar_nodes.h"
#include "reflectance/integral/refinement.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// A weighted sum of f(i, r) mu_r sin(xi) over places in polar coordinates, evaluated block by block: by the surface's
/// fast path where its bound is far below the tolerance, and counted as an error, else exactly.
class PolarSum {
 public:
  PolarSum(const Surface& surface, const Direction& i, const Direction& axis, double relative_tolerance);

  /// Turns to the meridian psi, up to the horizon; what follows is on it.
  void set_meridian(double cos_psi, double sin_psi);
  /// The arc from the axis to the horizon on this meridian [rad].
  [[nodiscard]] double length() const { return length_; }
  /// `weight` that of d(xi) d(psi); `left` = length() - xi.
  void add(double xi, double left, double weight) {
    nodes_.xi[count_] = xi;
    nodes_.left[count_] = left;
    nodes_.rise[count_] = rise_;
    nodes_.cos_psi[count_] = cos_psi_;
    nodes_.sin_psi[count_] = sin_psi_;
    weights_[count_] = weight;
    if (++count_ == DirectionBlock::kSize) flush();
  }
  /// The sum of all that was added.
  [[nodiscard]] RuleSum finished();

 private:
  void flush();

  const Surface& surface_;
  Direction i_;
  Direction axis_;
  Angle origin_;
  double fast_error_;  ///< relative; 0 when evaluated exactly
  bool is_fast_;
  double cos_psi_ = 1.0;
  double sin_psi_ = 0.0;
  double rise_ = 1.0;
  double length_ = 0.0;
  PolarNodes nodes_;
  DirectionBlock::Row weights_{};
  DirectionBlock directions_;
  std::size_t count_ = 0;
  RuleSum sum_;
};

}  // namespace gonio::reflectance
