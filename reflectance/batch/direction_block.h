#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <span>

#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// 64 directions, each part of them in a row of its own: what a vector unit reads. Lane k of all rows together is one
/// `Direction`, under the same promises (rows in radians; phi in (-pi, pi]); all lanes are the normal at first, so that
/// those never set do no harm. 2.5 kB. Threads: as any value.
struct alignas(64) DirectionBlock {
  static constexpr std::size_t kSize = 64;
  using Row = std::array<double, kSize>;

  Row mu;
  Row sin_theta;
  Row theta;
  Row elevation;
  Row phi;

  DirectionBlock() {
    for (std::size_t k = 0; k < kSize; ++k) set(k, Direction());
  }

  void set(std::size_t k, const Direction& d) {
    mu[k] = d.mu();
    sin_theta[k] = d.sin_theta();
    theta[k] = d.theta().si();
    elevation[k] = d.elevation().si();
    phi[k] = d.phi().si();
  }

  /// The first lanes from `d`, at most kSize (asserted); the others keep what they have.
  void assign(std::span<const Direction> d) {
    assert(d.size() <= kSize);
    for (std::size_t k = 0; k < d.size(); ++k) set(k, d[k]);
  }

  [[nodiscard]] Direction at(std::size_t k) const {
    Direction d;
    d.mu_ = mu[k];
    d.sin_theta_ = sin_theta[k];
    d.theta_ = radians(theta[k]);
    d.elevation_ = radians(elevation[k]);
    d.phi_ = radians(phi[k]);
    return d;
  }
};

}  // namespace gonio::reflectance
