#pragma once

#include <array>
#include <cstdint>

#include "sim/scene/chance.h"

namespace gonio::sim {

/// A stationary Gaussian process of scene time with mean 0 and correlation exp(-dt^2 / 2 tau^2): a sum of waves with
/// frequencies from N(0, 1/tau^2) (random Fourier features: Rahimi and Recht 2007). Immutable; threads: any.
class SlowWander {
 public:
  /// `purpose` is its own alone; `correlation_s` > 0.
  SlowWander(std::uint64_t seed, Purpose purpose, double correlation_s);

  /// With this standard deviation over many seeds.
  [[nodiscard]] double at(double scene_s, double deviation) const;

 private:
  struct Wave {
    double frequency = 0.0;  ///< rad/s
    double phase = 0.0;
  };
  std::array<Wave, 24> waves_{};
};

}  // namespace gonio::sim
