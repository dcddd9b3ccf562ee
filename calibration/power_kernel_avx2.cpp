// The only file of the room with a processor's own instructions: 16 pixels at a time, in 16-bit products.
//
// d = pixel - 32768 fills 16 bits, and its square is split so that both halves and their products fit:
//
//     d^2 = 2^15 (high + 2^14) + low,    |high| <= 2^14,  |low| <= 2^14
//
// With E = 2^15 high + low, which is d^2 - 2^29:
//
//     d^3 = 2^15 d high + d low + 2^29 d
//     d^4 = E^2 + 2^30 E + 2^58,         E^2 = 2^30 high^2 + 2^16 high low + low^2
//
// Products of 16 bits are added in pairs by one instruction (madd). Two vectors' pairs of d high and d low, four
// vectors' of the others, fit 32 bits; then they go into a SplitSum.
#include "calibration/power_kernel.h"

#if defined(__x86_64__)
#include <immintrin.h>

#include <algorithm>
#include <array>
#include <cstddef>

#define GONIO_AVX2 [[gnu::target("avx2"), gnu::always_inline]] static inline

namespace gonio::calibration {
namespace {

constexpr std::size_t kLanes = 16;
constexpr std::size_t kGroup = 4;       // vectors
constexpr std::size_t kCacheLine = 32;  // pixels
// So few that the sums below, over all lanes, stay inside of 32 bits: |d| 2^15 in each of 2^15 pixels.
constexpr std::size_t kMostAtOnce = 32768;
constexpr std::int64_t k2To15 = 1 << 15, k2To16 = 1 << 16, k2To29 = 1 << 29, k2To30 = 1 << 30;

/// A sum of 32-bit numbers beyond 32 bits without widening each: `wrapped` is right modulo 2^32, `high` sums the upper
/// halves. The lower halves add up to less than 2^32, so that wrapped - 2^16 high modulo 2^32 is their sum.
struct SplitSum {
  __m256i wrapped;
  __m256i high;
};

struct VectorSums {
  __m256i d, high, low, below;
  SplitSum d_high, d_low, high_high, high_low, low_low;
};

/// What does not change from pixel to pixel.
struct VectorConstants {
  __m256i middle, ones, quarter, threshold;
};

GONIO_AVX2 void take_signed(SplitSum& sum, __m256i terms) {
  sum.wrapped = _mm256_add_epi32(sum.wrapped, terms);
  sum.high = _mm256_add_epi32(sum.high, _mm256_srai_epi32(terms, 16));
}

GONIO_AVX2 void take_unsigned(SplitSum& sum, __m256i terms) {
  sum.wrapped = _mm256_add_epi32(sum.wrapped, terms);
  sum.high = _mm256_add_epi32(sum.high, _mm256_srli_epi32(terms, 16));
}

GONIO_AVX2 __m256i add_products(__m256i to, __m256i a, __m256i b) {
  return _mm256_add_epi32(to, _mm256_madd_epi16(a, b));
}

GONIO_AVX2 __m256i load(const std::uint16_t* pixels, const VectorConstants& constants) {
  return _mm256_xor_si256(constants.middle, _mm256_loadu_si256(reinterpret_cast<const __m256i*>(pixels)));
}

/// Adds vectors of d, at most kGroup of them.
template <std::size_t kVectors>
GONIO_AVX2 void add_group(const __m256i (&group)[kVectors], const VectorConstants& constants, VectorSums& sums) {
  const __m256i zero = _mm256_setzero_si256();
  __m256i d_high = zero, d_low = zero, high_high = zero, high_low = zero, low_low = zero;
  for (std::size_t k = 0; k < kVectors; ++k) {
    const __m256i d = group[k];
    const __m256i rounded = _mm256_mulhrs_epi16(d, d);  // d^2 / 2^15; 2^15 itself becomes right by the next line
    const __m256i high = _mm256_sub_epi16(rounded, constants.quarter);
    const __m256i low = _mm256_sub_epi16(_mm256_mullo_epi16(d, d), _mm256_slli_epi16(rounded, 15));
    sums.below = _mm256_sub_epi16(sums.below, _mm256_cmpgt_epi16(constants.threshold, d));
    sums.d = add_products(sums.d, d, constants.ones);
    sums.high = add_products(sums.high, high, constants.ones);
    sums.low = add_products(sums.low, low, constants.ones);
    d_high = add_products(d_high, d, high);
    d_low = add_products(d_low, d, low);
    high_high = add_products(high_high, high, high);
    high_low = add_products(high_low, high, low);
    low_low = add_products(low_low, low, low);
    if (k % 2 == 0 && k + 1 < kVectors) continue;
    take_signed(sums.d_high, d_high);
    take_signed(sums.d_low, d_low);
    d_high = d_low = zero;
  }
  // Squares: four vectors of them may reach 2^31, which unsigned holds.
  take_unsigned(sums.high_high, high_high);
  take_signed(sums.high_low, high_low);
  take_unsigned(sums.low_low, low_low);
}

/// Each vector's own sum, modulo 2^32.
GONIO_AVX2 __m128i sums_of_lanes(__m256i a, __m256i b, __m256i c, __m256i d) {
  const __m256i pairs = _mm256_hadd_epi32(_mm256_hadd_epi32(a, b), _mm256_hadd_epi32(c, d));
  return _mm_add_epi32(_mm256_castsi256_si128(pairs), _mm256_extracti128_si256(pairs, 1));
}

/// Over all lanes.
struct Totals {
  std::int64_t d, high, low, below, d_high, d_low, high_high, high_low, low_low;
};

std::int64_t total(std::int32_t wrapped, std::int32_t high) {
  const auto lower = static_cast<std::uint32_t>(wrapped) - (static_cast<std::uint32_t>(high) << 16U);
  return std::int64_t{high} * 65536 + lower;
}

GONIO_AVX2 Totals totals_of(const VectorSums& sums, const VectorConstants& constants) {
  alignas(16) std::int32_t of[16];
  const auto store = [](std::int32_t* to, __m128i four) { _mm_store_si128(reinterpret_cast<__m128i*>(to), four); };
  store(of, sums_of_lanes(sums.d, sums.high, sums.low, _mm256_madd_epi16(sums.below, constants.ones)));
  store(of + 4, sums_of_lanes(sums.d_high.wrapped, sums.d_high.high, sums.d_low.wrapped, sums.d_low.high));
  store(of + 8, sums_of_lanes(sums.high_high.wrapped, sums.high_high.high, sums.high_low.wrapped, sums.high_low.high));
  store(of + 12, sums_of_lanes(sums.low_low.wrapped, sums.low_low.high, sums.below, sums.below));
  return {.d = of[0],
          .high = of[1],
          .low = of[2],
          .below = of[3],
          .d_high = total(of[4], of[5]),
          .d_low = total(of[6], of[7]),
          .high_high = total(of[8], of[9]),
          .high_low = total(of[10], of[11]),
          .low_low = total(of[12], of[13])};
}

/// `pixels` of them, and fill of d = 0 that counts in the totals but adds nothing to a sum of powers.
void put(const Totals& of, std::size_t pixels, std::size_t fill, std::uint16_t full_scale, PowerSums& sums) {
  const auto lanes = static_cast<std::int64_t>(pixels + fill);
  const std::int64_t e = k2To15 * of.high + of.low;
  const Wide e2 = Wide{k2To30} * of.high_high + k2To16 * of.high_low + of.low_low;
  sums.n += static_cast<std::int64_t>(pixels);
  sums.sum1 += of.d;
  sums.sum2 += e + k2To29 * lanes;
  sums.sum3 += k2To15 * of.d_high + of.d_low + k2To29 * of.d;
  sums.sum4 += e2 + Wide{k2To30} * e + Wide{k2To29} * k2To29 * lanes;
  sums.saturated += lanes - of.below - (full_scale <= kPowerShift ? static_cast<std::int64_t>(fill) : 0);
}

void prefetch(std::span<const std::uint16_t> soon, std::size_t from, std::size_t to) {
  for (std::size_t at = from; at < std::min(to, soon.size()); at += kCacheLine) {
    _mm_prefetch(reinterpret_cast<const char*>(soon.data() + at), _MM_HINT_T0);
  }
}

[[gnu::target("avx2")]] void add_some(std::span<const std::uint16_t> pixels, std::span<const std::uint16_t> soon,
                                      std::uint16_t full_scale, PowerSums& sums) {
  // The last vector overlaps the one before it; what was counted there is masked to d = 0.
  alignas(32) static constexpr std::array<std::int16_t, 2 * kLanes> kMask{
      0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
  const VectorConstants constants{.middle = _mm256_set1_epi16(static_cast<std::int16_t>(-kPowerShift)),
                                  .ones = _mm256_set1_epi16(1),
                                  .quarter = _mm256_set1_epi16(1 << 14),
                                  .threshold = _mm256_set1_epi16(static_cast<std::int16_t>(full_scale - kPowerShift))};
  const __m256i zero = _mm256_setzero_si256();
  const SplitSum nothing{zero, zero};
  VectorSums vectors{zero, zero, zero, zero, nothing, nothing, nothing, nothing, nothing};
  const std::uint16_t* at = pixels.data();
  std::size_t left = pixels.size();
  for (; left >= kGroup * kLanes; at += kGroup * kLanes, left -= kGroup * kLanes) {
    prefetch(soon, pixels.size() - left, pixels.size() - left + kGroup * kLanes);
    add_group<kGroup>({load(at, constants), load(at + kLanes, constants), load(at + 2 * kLanes, constants),
                       load(at + 3 * kLanes, constants)},
                      constants, vectors);
  }
  prefetch(soon, pixels.size() - left, soon.size());
  for (; left >= kLanes; at += kLanes, left -= kLanes) add_group<1>({load(at, constants)}, constants, vectors);
  const std::size_t fill = left == 0 ? 0 : kLanes - left;
  if (fill > 0) {
    const __m256i mask = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(kMask.data() + left));
    add_group<1>({_mm256_and_si256(mask, load(at - fill, constants))}, constants, vectors);
  }
  put(totals_of(vectors, constants), pixels.size(), fill, full_scale, sums);
}

}  // namespace

void add_powers_avx2(std::span<const std::uint16_t> pixels, std::span<const std::uint16_t> soon,
                     std::uint16_t full_scale, PowerSums& sums) {
  if (pixels.size() < kLanes) return power_kernels().back().add(pixels, soon, full_scale, sums);
  while (!pixels.empty()) {
    // Never fewer than a vector is left over.
    const std::size_t n = pixels.size() < kMostAtOnce + kLanes ? pixels.size() : kMostAtOnce;
    add_some(pixels.first(n), soon, full_scale, sums);
    pixels = pixels.subspan(n);
    soon = soon.subspan(std::min(n, soon.size()));
  }
}

}  // namespace gonio::calibration
#endif
