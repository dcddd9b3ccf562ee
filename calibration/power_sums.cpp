// Plain loops for the compiler to vectorise (this file is built with -O3 whatever the build, see CMakeLists.txt), once
// for any x86-64 and once for AVX2. Integers only: both give the same bits.
#include "calibration/power_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "calibration/vector_clones.h"

namespace gonio::calibration {
namespace {

constexpr std::uint16_t kTwelveBits = 4095;
constexpr std::int32_t kMiddle = 2048;  // of twelve bits
// So many that no 32-bit sum below overflows: 256 * 4095^2 < 2^32, 256 * 2048 * 4095 < 2^31.
constexpr std::size_t kBlock = 256;

/// What a block adds, in the width that its sums need.
struct BlockSums {
  std::int64_t sum1 = 0;
  std::int64_t sum2 = 0;
  std::int64_t sum3 = 0;
  Wide sum4 = 0;
  std::int64_t saturated = 0;
};

GONIO_INLINE std::int16_t narrow(std::int32_t value) {
  return static_cast<std::int16_t>(value);
}

// d = pixel - 2048 lies in -2048..2047, its square is split as d^2 = 4096 high + low, so that every product fits 16 x
// 16 bits:  d^3 = 4096 d high + d low,  d^4 = 4096^2 high^2 + 2 4096 high low + low^2.
GONIO_INLINE BlockSums sum_twelve_bits(const std::uint16_t* pixels, std::size_t n, std::int32_t full_scale) {
  alignas(32) std::array<std::int16_t, kBlock> d, high, low;
  for (std::size_t k = 0; k < n; ++k) {
    const std::int16_t x = narrow(pixels[k] - kMiddle);
    const std::int16_t x4 = narrow(x * 4);
    d[k] = x;
    high[k] = narrow((std::int32_t{x4} * std::int32_t{x4}) >> 16);
    low[k] = narrow((x * x) & 4095);
  }
  std::int32_t d1 = 0, d2 = 0, d_high = 0, d_low = 0, high_low = 0, high2 = 0;
  std::uint32_t low2 = 0;
  for (std::size_t k = 0; k < n; ++k) {
    d1 += d[k];
    d2 += std::int32_t{d[k]} * d[k];
    d_high += std::int32_t{d[k]} * high[k];
    d_low += std::int32_t{d[k]} * low[k];
    high_low += std::int32_t{high[k]} * low[k];
    high2 += std::int32_t{high[k]} * high[k];
    low2 += static_cast<std::uint32_t>(std::int32_t{low[k]} * low[k]);
  }
  BlockSums sums{.sum1 = d1, .sum2 = d2, .sum3 = 4096 * std::int64_t{d_high} + d_low};
  sums.sum4 = 16777216 * std::int64_t{high2} + 8192 * std::int64_t{high_low} + std::int64_t{low2};
  std::int16_t top = d[0];
  for (std::size_t k = 0; k < n; ++k) top = std::max(top, d[k]);
  if (top < full_scale - kMiddle) return sums;
  for (std::size_t k = 0; k < n; ++k) sums.saturated += d[k] >= full_scale - kMiddle ? 1 : 0;
  return sums;
}

// d^2 < 2^32 is split as 2^16 high + low: d^2 high and d^2 low stay below 2^48, and their sums below 2^56.
GONIO_INLINE BlockSums sum_sixteen_bits(const std::uint16_t* pixels, std::size_t n, std::int32_t shift,
                                        std::int32_t full_scale) {
  std::int64_t d1 = 0, d2_sum = 0, d3 = 0;
  std::uint64_t with_high = 0, with_low = 0;
  std::int32_t saturated = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const std::int32_t d = pixels[k] - shift;
    const std::uint32_t square = static_cast<std::uint32_t>(d) * static_cast<std::uint32_t>(d);
    d1 += d;
    d2_sum += square;
    d3 += std::int64_t{square} * d;
    with_high += std::uint64_t{square} * (square >> 16U);
    with_low += std::uint64_t{square} * (square & 0xFFFFU);
    saturated += pixels[k] >= full_scale ? 1 : 0;
  }
  return {
      .sum1 = d1, .sum2 = d2_sum, .sum3 = d3, .sum4 = Wide{with_high} * 65536 + Wide{with_low}, .saturated = saturated};
}

GONIO_INLINE bool holds_more(const std::uint16_t* pixels, std::size_t n, std::uint16_t most) {
  std::uint16_t top = 0;
  for (std::size_t k = 0; k < n; ++k) top = std::max(top, pixels[k]);
  return top > most;
}

GONIO_INLINE void add_all(std::span<const std::uint16_t> pixels, std::int32_t shift, std::uint16_t full_scale,
                          PowerSums& sums) {
  for (std::size_t from = 0; from < pixels.size(); from += kBlock) {
    const std::size_t n = std::min(kBlock, pixels.size() - from);
    const std::uint16_t* block = pixels.data() + from;
    // A pixel beyond the scale that its format states is possible on a wire, and counts as saturated.
    const bool is_quick = shift == kMiddle && !holds_more(block, n, kTwelveBits);
    const BlockSums added =
        is_quick ? sum_twelve_bits(block, n, full_scale) : sum_sixteen_bits(block, n, shift, full_scale);
    sums.sum1 += added.sum1;
    sums.sum2 += added.sum2;
    sums.sum3 += added.sum3;
    sums.sum4 += added.sum4;
    sums.saturated += added.saturated;
  }
  sums.n += static_cast<std::int64_t>(pixels.size());
}

GONIO_CLONE(add_all_here, add_all,
            (std::span<const std::uint16_t> pixels, std::int32_t shift, std::uint16_t full_scale, PowerSums& sums),
            (pixels, shift, full_scale, sums))

}  // namespace

PowerSummer::PowerSummer(std::uint16_t full_scale)
    : full_scale_(full_scale), shift_(full_scale <= kTwelveBits ? kMiddle : (full_scale + 1) / 2) {}

void PowerSummer::add(std::span<const std::uint16_t> pixels, PowerSums& sums) const {
  add_all_here(pixels, shift_, full_scale_, sums);
}

void PowerSummer::remove(std::uint16_t pixel, PowerSums& sums) const {
  const Wide d = pixel - shift_;
  sums.n -= 1;
  sums.sum1 -= d;
  sums.sum2 -= d * d;
  sums.sum3 -= d * d * d;
  sums.sum4 -= d * d * d * d;
  sums.saturated -= pixel >= full_scale_ ? 1 : 0;
}

RegionMoments PowerSummer::moments(const PowerSums& sums) const {
  const Wide n = sums.n;
  const Wide k = (2 * sums.sum1 + (sums.sum1 >= 0 ? n : -n)) / (2 * n);  // the nearest whole DN
  const Wide s1 = sums.sum1 - n * k;
  const Wide s2 = sums.sum2 - 2 * k * sums.sum1 + n * k * k;
  const Wide s3 = sums.sum3 - 3 * k * sums.sum2 + 3 * k * k * sums.sum1 - n * k * k * k;
  const Wide s4 = sums.sum4 - 4 * k * sums.sum3 + 6 * k * k * sums.sum2 - 4 * k * k * k * sums.sum1 + n * k * k * k * k;
  const auto count = static_cast<double>(sums.n);
  const double rest = static_cast<double>(s1) / count;  // of the mean, at most half a DN
  const double p2 = static_cast<double>(s2) / count;
  const double p3 = static_cast<double>(s3) / count;
  const double p4 = static_cast<double>(s4) / count;
  const double rest2 = rest * rest;
  return {.n = static_cast<std::uint32_t>(sums.n),
          .mean = static_cast<double>(shift_ + static_cast<std::int64_t>(k)) + rest,
          .m2 = p2 - rest2,
          .m3 = p3 - 3.0 * rest * p2 + 2.0 * rest * rest2,
          .m4 = p4 - 4.0 * rest * p3 + 6.0 * rest2 * p2 - 3.0 * rest2 * rest2,
          .saturated = static_cast<std::uint32_t>(sums.saturated)};
}

}  // namespace gonio::calibration
