#pragma once

#include <cmath>
#include <numbers>

#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// Two independent draws from [0, 1]. Chance is the caller's: the same point gives the same sample.
struct UnitPoint {
  double u = 0.0;
  double v = 0.0;
};

/// One direction drawn for light that comes from i (Mobley 2005, appendix C: C1). A photon's weight is multiplied by
/// `weight`, whose mean over the draws is rho_dh(i), mirror part included.
struct DirectionSample {
  Direction r;
  double weight = 0.0;
  bool is_specular = false;  ///< drawn from the mirror part, whose density is a delta
};

/// mu drawn with density (k + 2) mu^(k+1) on [0, 1], phi evenly: mu = u^(1/(k+2)), and sin^2 = 1 - mu^2 without the
/// subtraction. k > -2; k = 0 is the cosine law.
[[nodiscard]] inline Direction power_cosine_direction(double k, UnitPoint draw) {
  const Angle phi = radians(2.0 * std::numbers::pi * (draw.v - 0.5));
  if (k == 0.0) return Direction::from_cosine(std::sqrt(draw.u), std::sqrt(1.0 - draw.u), phi);
  const double log_mu = std::log(draw.u) / (k + 2.0);
  return Direction::from_cosine(std::exp(log_mu), std::sqrt(-std::expm1(2.0 * log_mu)), phi);
}

}  // namespace gonio::reflectance
