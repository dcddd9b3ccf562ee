#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// Directions drawn for property tests, deterministic for a seed: half of them anywhere, half close to the pole, the
/// horizon, or the direction drawn before, at distances from 1 down to 1e-14 rad.
class GeneratedDirections {
 public:
  explicit GeneratedDirections(std::uint64_t seed) : engine_(seed) {}

  Direction next() {
    constexpr double kQuarter = 1.5707963267948966;
    const double distance = std::pow(10.0, -14.0 * unit());
    double theta = kQuarter * unit();
    double phi = 4.0 * kQuarter * (unit() - 0.5);
    switch (engine_() % 6) {
      case 0:
        theta = distance;
        break;
      case 1:
        theta = kQuarter - distance;
        break;
      case 2:
        theta = last_.theta().si() + distance * (unit() - 0.5);
        phi = last_.phi().si() + distance * (unit() - 0.5);
        break;
      default:
        break;
    }
    last_ = Direction::from_angles(radians(std::clamp(theta, 0.0, kQuarter)), radians(phi));
    return last_;
  }

  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 engine_;
  Direction last_;
};

}  // namespace gonio::reflectance
