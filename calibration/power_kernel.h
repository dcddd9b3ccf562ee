#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "calibration/power_sums.h"

namespace gonio::calibration {

/// One way to add rows of pixels to the sums. All ways add the same integers.
struct PowerKernel {
  std::string_view name;
  /// Pixels at `full_scale` or above count as saturated. `soon` are rows that are going to be added later: the first is
  /// called from memory while the first of `rows` is summed, the second with the second; there may be none, or more
  /// than rows. Any length, any alignment. Threads: any.
  void (*add)(PixelRows rows, PixelRows soon, std::uint16_t full_scale, PowerSums& sums) = nullptr;
};

/// Those that this processor can run, the quickest first; the last is plain C++ and always there.
[[nodiscard]] std::span<const PowerKernel> power_kernels();

#if defined(__x86_64__)
/// For processors with AVX2, with AVX-512 (BW and VNNI) only; `power_kernels` knows.
void add_powers_avx2(PixelRows rows, PixelRows soon, std::uint16_t full_scale, PowerSums& sums);
void add_powers_avx512(PixelRows rows, PixelRows soon, std::uint16_t full_scale, PowerSums& sums);
#endif

}  // namespace gonio::calibration
