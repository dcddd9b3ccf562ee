#include "calibration/power_kernel.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace gonio::calibration {
namespace {

// d^2 <= 2^30 is split as 2^16 high + low, so that a block's sums of d^2 high (below 2^44) and of d^2 low (below 2^46)
// stay in 64 bits.
constexpr std::size_t kBlock = 256;

void add_block(std::span<const std::uint16_t> pixels, std::uint16_t full_scale, PowerSums& sums) {
  std::int64_t d1 = 0, d2 = 0, d3 = 0;
  std::uint64_t with_high = 0, with_low = 0;
  std::int32_t saturated = 0;
  for (const std::uint16_t pixel : pixels) {
    const std::int32_t d = pixel - kPowerShift;
    const auto square = static_cast<std::uint32_t>(d * d);
    d1 += d;
    d2 += square;
    d3 += std::int64_t{square} * d;
    with_high += std::uint64_t{square} * (square >> 16U);
    with_low += std::uint64_t{square} * (square & 0xFFFFU);
    saturated += pixel >= full_scale ? 1 : 0;
  }
  sums.sum1 += d1;
  sums.sum2 += d2;
  sums.sum3 += d3;
  sums.sum4 += Wide{with_high} * 65536 + Wide{with_low};
  sums.saturated += saturated;
}

void add_powers_plain(PixelRows rows, PixelRows /*soon*/, std::uint16_t full_scale, PowerSums& sums) {
  for (const auto row : rows) {
    for (std::size_t from = 0; from < row.size(); from += kBlock) {
      add_block(row.subspan(from, std::min(kBlock, row.size() - from)), full_scale, sums);
    }
    sums.n += static_cast<std::int64_t>(row.size());
  }
}

}  // namespace

std::span<const PowerKernel> power_kernels() {
#if defined(__x86_64__)
  static constexpr std::array kKernels{PowerKernel{"avx512", add_powers_avx512}, PowerKernel{"avx2", add_powers_avx2},
                                       PowerKernel{"plain", add_powers_plain}};
  static const std::size_t first = []() -> std::size_t {
    if (__builtin_cpu_supports("avx2") == 0) return 2;
    return __builtin_cpu_supports("avx512bw") == 0 || __builtin_cpu_supports("avx512vnni") == 0 ? 1 : 0;
  }();
  return std::span(kKernels).subspan(first);
#else
  static constexpr std::array kKernels{PowerKernel{"plain", add_powers_plain}};
  return kKernels;
#endif
}

}  // namespace gonio::calibration
