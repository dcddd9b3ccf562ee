#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "calibration/power_sums.h"

namespace gonio::calibration {

/// One way to add a row of pixels to the sums. All ways add the same integers.
struct PowerKernel {
  std::string_view name;
  /// Pixels at `full_scale` or above count as saturated. `soon` are pixels that are going to be added later: they are
  /// called from memory while these are summed, and may be none. Any length, any alignment. Threads: any.
  void (*add)(std::span<const std::uint16_t> pixels, std::span<const std::uint16_t> soon, std::uint16_t full_scale,
              PowerSums& sums) = nullptr;
};

/// Those that this processor can run, the quickest first; the last is plain C++ and always there.
[[nodiscard]] std::span<const PowerKernel> power_kernels();

#if defined(__x86_64__)
/// For a processor with AVX2 only; `power_kernels` knows.
void add_powers_avx2(std::span<const std::uint16_t> pixels, std::span<const std::uint16_t> soon,
                     std::uint16_t full_scale, PowerSums& sums);
#endif

}  // namespace gonio::calibration
