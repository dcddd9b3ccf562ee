#pragma once

#include <cstdint>
#include <span>

#include "calibration/raw_reading.h"

namespace gonio::calibration {

__extension__ using Wide = __int128;  ///< 128 bits: sums of fourth powers of a frame stay exact

inline constexpr std::int32_t kPowerShift = 32768;  ///< DN: the middle of 16 bits

/// Sums over pixels of the powers of (pixel - kPowerShift), exact integers: their order changes no bit, so any two
/// machines and any two ways to vectorise agree, and what does not count is taken out again without a trace.
struct PowerSums {
  std::int64_t n = 0;
  Wide sum1 = 0;
  Wide sum2 = 0;
  Wide sum3 = 0;
  Wide sum4 = 0;
  std::int64_t saturated = 0;  ///< pixels at full scale or above
};

/// Mean and central moments. The sums are moved to the whole DN next to the mean in integers, so that nothing of a
/// bright, even frame cancels. `sums` must hold a pixel.
[[nodiscard]] RegionMoments moments_of(const PowerSums& sums);

struct PowerKernel;

using PixelRows = std::span<const std::span<const std::uint16_t>>;

/// Sums powers the quickest way that this processor has (`power_kernel.h`).
class PowerSummer {
 public:
  explicit PowerSummer(std::uint16_t full_scale);

  /// `soon` are rows that come later, to be called from memory meanwhile, one with each row.
  void add(PixelRows rows, PixelRows soon, PowerSums& sums) const;
  /// Takes one pixel out that was added.
  void remove(std::uint16_t pixel, PowerSums& sums) const;

 private:
  std::uint16_t full_scale_;
  const PowerKernel* kernel_;
};

}  // namespace gonio::calibration
