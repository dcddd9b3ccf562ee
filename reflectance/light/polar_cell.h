#pragma once

#include <functional>
#include <vector>

#include "base/units.h"
#include "reflectance/direction/direction.h"
#include "reflectance/integral/refinement.h"

namespace gonio::reflectance {

/// A convex part of the sky in polar coordinates about one of its directions, `axis`, where an integrand may have a
/// kink or a peak: there it is no more than an end of the range. Bounded by the horizon, by halves of the sky, by a
/// disk.
class PolarCell {
 public:
  explicit PolarCell(const Direction& axis);

  /// Keeps what is closer to the axis than to `other`, which has to differ from it.
  void keep_nearer_than(const Direction& other);
  /// Keeps what is within `radius` (at most 45 deg) of the direction (theta, phi), which may lie below the horizon. The
  /// axis has to be inside.
  void keep_within(Angle theta, Angle phi, Angle radius);

  /// Adds h(i) mu_i dOmega_i over the cell, by the double-exponential rule of `level` (0 to 8) both ways.
  void add_to(RuleSum& sum, const std::function<double(const Direction&)>& h, int level) const;

 private:
  // The edge that a meridian meets: n . x = height, with n . axis - height and n . tangent(psi) = cos(psi) toward +
  // sin(psi) aside.
  struct Edge {
    Vector n;
    double inside;  // n . axis - height, without cancellation
    double height;
    double at_axis;  // n . axis
    double toward;
    double aside;
    [[nodiscard]] double reach(double cos_psi, double sin_psi) const;
  };

  void keep(const Vector& n, double inside, double height);
  void add_corners(const Edge& a, const Edge& b);
  void add_break(double psi);

  Direction axis_;
  Vector up_;     // tangent at psi = 0
  Vector aside_;  // tangent at psi = 90 deg
  std::vector<Edge> edges_;
  std::vector<double> breaks_;  // of psi, ascending from -pi to pi
};

}  // namespace gonio::reflectance
