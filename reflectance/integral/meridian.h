#pragma once

#include <cmath>

#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// One meridian of polar coordinates about `axis`: directions at the arc xi from it in the azimuth psi about it, psi =
/// 0 towards the normal; up to the horizon.
class Meridian {
 public:
  Meridian(const Direction& axis, double cos_psi, double sin_psi)
      : axis_(axis),
        cos_psi_(cos_psi),
        sin_psi_(sin_psi),
        rise_(std::hypot(axis.mu(), axis.sin_theta() * cos_psi)),
        length_(std::atan2(axis.mu(), -axis.sin_theta() * cos_psi)) {}

  /// The arc from the axis to the horizon [rad].
  [[nodiscard]] double length() const { return length_; }

  /// `left` = length - xi, given apart: mu = rise sin(left) keeps its digits at the horizon.
  [[nodiscard]] Direction at(double xi, double left) const {
    const double sin_xi = std::sin(xi);
    const double mu = rise_ * std::sin(left);
    const double forward = std::cos(xi) * axis_.sin_theta() - sin_xi * cos_psi_ * axis_.mu();
    const double aside = sin_xi * sin_psi_;
    const Angle turn = radians(std::atan2(aside, forward));
    return Direction::from_cosine(mu, std::hypot(forward, aside), axis_.phi() + turn);
  }

 private:
  Direction axis_;
  double cos_psi_;
  double sin_psi_;
  double rise_;
  double length_;
};

}  // namespace gonio::reflectance
