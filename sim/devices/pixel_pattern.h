#pragma once

#include <cstdint>
#include <vector>

#include "sim/scene/scene.h"

namespace gonio::sim {

/// What is wrong with each pixel of the camera, the same in every frame of a scene's seed: its response, normal about 1
/// with the scene's `flat_sigma`, and whether it is bad: one whose well is full at a tenth of the scale.
class PixelPattern {
 public:
  static constexpr double kEarlyFull = 0.1;  ///< of full scale

  PixelPattern(const DetectorSpec& spec, std::uint64_t seed);
  /// Neither is named in the scene: there is no pattern, and asking costs nothing.
  [[nodiscard]] bool is_even() const { return pixels_.empty(); }
  [[nodiscard]] double response(int x, int y) const { return is_even() ? 1.0 : at(x, y).response; }
  [[nodiscard]] bool is_bad(int x, int y) const { return !is_even() && at(x, y).is_bad; }

 private:
  struct Pixel {
    double response = 1.0;
    bool is_bad = false;
  };
  [[nodiscard]] const Pixel& at(int x, int y) const {
    return pixels_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)];
  }
  std::size_t width_;
  std::vector<Pixel> pixels_;
};

}  // namespace gonio::sim
