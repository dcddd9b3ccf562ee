#include "sim/devices/pixel_pattern.h"

#include <algorithm>

#include "sim/scene/chance.h"

namespace gonio::sim {

PixelPattern::PixelPattern(const DetectorSpec& spec, std::uint64_t seed)
    : width_(static_cast<std::size_t>(spec.width_px)) {
  if (spec.flat_sigma == 0.0 && spec.bad_fraction == 0.0) return;
  constexpr double kLeast = 0.1;  // a response is positive, however wide its distribution
  Chance chance(seed, Purpose::PixelPattern);
  pixels_.resize(width_ * static_cast<std::size_t>(spec.height_px));
  for (Pixel& pixel : pixels_) {
    pixel.response = std::max(kLeast, 1.0 + spec.flat_sigma * chance.normal());
    pixel.is_bad = chance.uniform() < spec.bad_fraction;
  }
}

}  // namespace gonio::sim
