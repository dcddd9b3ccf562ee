#pragma once

#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// Models that divide by mu take a direction in the horizon as lying this far above it, so that `eval` stays finite. A
/// billion times closer to 90 deg than any goniometer reads, and by 1/mu^2 still far from overflow.
constexpr double kLeastMu = 1e-12;

[[nodiscard]] inline double clamped_mu(const Direction& d) {
  return std::max(d.mu(), kLeastMu);
}

}  // namespace gonio::reflectance
