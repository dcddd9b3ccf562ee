#pragma once

#include <cstdint>
#include <vector>

#include "sim/scene/effects_spec.h"

namespace gonio::sim {

/// The grainy brightness of the pixels at one place: square grains whose brightness has mean 1 and the spec's contrast,
/// gamma distributed (Goodman, Speckle Phenomena in Optics, 2007, sec. 4.6: the sum of equal, fully developed
/// speckles). The lattice of grains lies anew for each place, so the correlation of two pixels (dx, dy) apart is (1 -
/// |dx|/grain)(1 - |dy|/grain), 0 beyond a grain. It depends on seed and place alone: repeats see the same pattern, and
/// no number of them averages it away. Immutable; threads: any.
class SpecklePattern {
 public:
  SpecklePattern(const SpeckleSpec& spec, int width_px, int height_px, std::uint64_t seed, std::uint64_t place);

  /// 1 everywhere without contrast.
  [[nodiscard]] double operator()(int x, int y) const;

 private:
  int grain_px_;
  int shift_x_ = 0;
  int shift_y_ = 0;
  int columns_ = 0;
  std::vector<double> grains_;  ///< [rows][columns]; empty without contrast
};

}  // namespace gonio::sim
