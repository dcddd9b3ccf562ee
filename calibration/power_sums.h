#pragma once

#include <cstdint>
#include <span>

#include "calibration/raw_reading.h"

namespace gonio::calibration {

__extension__ using Wide = __int128;  ///< 128 bits: sums of fourth powers of a frame stay exact

/// Sums over pixels of the powers of (pixel - shift), exact integers: their order changes no bit, so any two machines
/// and any two ways to vectorise agree, and what does not count is taken out again without a trace.
struct PowerSums {
  std::int64_t n = 0;
  Wide sum1 = 0;
  Wide sum2 = 0;
  Wide sum3 = 0;
  Wide sum4 = 0;
  std::int64_t saturated = 0;  ///< pixels at full scale or above
};

/// Sums powers about the middle of the scale. At most 12 bits take the quick way (16-bit products); more take one of 64
/// bits.
class PowerSummer {
 public:
  explicit PowerSummer(std::uint16_t full_scale);

  void add(std::span<const std::uint16_t> pixels, PowerSums& sums) const;
  /// Takes one pixel out that was added.
  void remove(std::uint16_t pixel, PowerSums& sums) const;
  /// Mean and central moments. The sums are moved to the whole DN next to the mean in integers, so that nothing of a
  /// bright, even frame cancels. `sums` must hold a pixel.
  [[nodiscard]] RegionMoments moments(const PowerSums& sums) const;

 private:
  std::uint16_t full_scale_;
  std::int32_t shift_;
};

}  // namespace gonio::calibration
