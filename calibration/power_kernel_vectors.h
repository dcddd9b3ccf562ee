#pragma once

// Sums of powers in vectors of 16-bit words, for the files that know a processor's own instructions: included by one
// file an instruction set, which is built for it (CMakeLists.txt), and by no other.
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
#include <array>
#include <cstddef>
#include <cstring>

#include "calibration/power_kernel.h"

namespace gonio::calibration {
namespace {

// So few that the sums below, over all lanes, stay inside of 32 bits: |d| 2^15 in each of 2^15 pixels.
constexpr std::size_t kMostPixels = 32768;
constexpr std::size_t kMostOfARow = 16384;
constexpr std::size_t kCacheLine = 32;  // pixels
constexpr std::int64_t k2To15 = 1 << 15, k2To16 = 1 << 16, k2To29 = 1 << 29, k2To30 = 1 << 30;

/// Over all lanes.
struct Totals {
  std::int64_t d, high, low, below, d_high, d_low, high_high, high_low, low_low;
};

/// `pixels` of them, and fill of d = 0 that counts in the totals but adds nothing to a sum of powers.
inline void put(const Totals& of, std::size_t pixels, std::size_t fill, std::uint16_t full_scale, PowerSums& sums) {
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

inline void prefetch(std::span<const std::uint16_t> soon, std::size_t from, std::size_t to) {
  for (std::size_t at = from; at < to && at < soon.size(); at += kCacheLine) __builtin_prefetch(soon.data() + at);
}

/// `Set` is an instruction set: its vectors of unsigned 16 and 32 bits `Words` and `Sums`, the same with signs
/// `SignedWords` and `SignedSums`, and of signed words
///   madd(a, b)          products, added in pairs to Sums,
///   add_madd(to, a, b)  the same added to `to`,
///   mulhrs(a, b)        (a b + 2^14) >> 15.
template <class Set>
class VectorSummer {
 public:
  explicit VectorSummer(std::uint16_t full_scale)
      : threshold_(Words{} + static_cast<std::uint16_t>(full_scale - kPowerShift)), full_scale_(full_scale) {}

  void add(PixelRows rows, PixelRows soon, PowerSums& sums) const {
    State state;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (rows[k].size() < kGroup)
        power_kernels().back().add(rows.subspan(k, 1), {}, full_scale_, sums);
      else
        add_row(rows[k], k < soon.size() ? soon[k] : Row(), state, sums);
    }
    put(totals(state), state.pixels, state.fill, full_scale_, sums);
  }

 private:
  using Row = std::span<const std::uint16_t>;
  using Words = typename Set::Words;
  using Sums = typename Set::Sums;
  using SignedWords = typename Set::SignedWords;
  using SignedSums = typename Set::SignedSums;
  static constexpr std::size_t kLanes = sizeof(Words) / sizeof(std::uint16_t);
  static constexpr std::size_t kGroup = 64;  // pixels
  static_assert(kGroup / kLanes == 2 || kGroup / kLanes == 4);

  // 0 for the pixels of the last group that the one before it held, all ones for the others.
  static constexpr auto kMask = [] {
    std::array<std::uint16_t, 2 * kGroup> mask{};
    for (std::size_t k = kGroup; k < mask.size(); ++k) mask[k] = 0xFFFF;
    return mask;
  }();

  /// A sum of signed 32-bit numbers beyond 32 bits without widening each: `wrapped` is right modulo 2^32, `high` sums
  /// the upper halves. The lower halves add up to less than 2^32, so that wrapped - 2^16 high modulo 2^32 is their sum.
  struct SplitSum {
    Sums wrapped{}, high{};
  };

  struct State {
    Words below{};
    Sums d{}, high{}, low{};
    SplitSum d_high, d_low, high_high, high_low, low_low;
    std::size_t pixels = 0;
    std::size_t fill = 0;  ///< lanes of d = 0 that are no pixel's
  };

  [[gnu::always_inline]] static Words load(const std::uint16_t* at) {
    Words words;
    std::memcpy(&words, at, sizeof words);
    return words;
  }

  [[gnu::always_inline]] static void take(SplitSum& sum, Sums terms) {
    sum.wrapped += terms;
    sum.high += reinterpret_cast<Sums>(reinterpret_cast<SignedSums>(terms) >> 16);
  }

  /// Four vectors of squares may reach 2^31, which has no sign.
  [[gnu::always_inline]] static void take_squares(SplitSum& sum, Sums terms) {
    sum.wrapped += terms;
    sum.high += terms >> 16;
  }

  /// Two or four vectors of pixels; where masked, those that count are d, the others 0.
  template <bool is_masked>
  [[gnu::always_inline]] void add_group(const std::uint16_t* pixels, const std::uint16_t* mask, State& to) const {
    const Words ones = Words{} + std::uint16_t{1};
    Sums d_high{}, d_low{}, high_high{}, high_low{}, low_low{};
    for (std::size_t k = 0; k < kGroup / kLanes; ++k) {
      Words d = load(pixels + k * kLanes) ^ std::uint16_t{kPowerShift};
      if constexpr (is_masked) d &= load(mask + k * kLanes);
      const Words rounded = Set::mulhrs(d, d);  // d^2 / 2^15; 2^15 has lost its sign, which the next line does not mind
      const Words high = rounded - std::uint16_t{1 << 14};
      const Words low = d * d - (rounded << 15);
      to.below -= reinterpret_cast<Words>(reinterpret_cast<SignedWords>(threshold_) > reinterpret_cast<SignedWords>(d));
      to.d = Set::add_madd(to.d, d, ones);
      to.high = Set::add_madd(to.high, high, ones);
      to.low = Set::add_madd(to.low, low, ones);
      d_high = k % 2 == 0 ? Set::madd(d, high) : Set::add_madd(d_high, d, high);
      d_low = k % 2 == 0 ? Set::madd(d, low) : Set::add_madd(d_low, d, low);
      high_high = k == 0 ? Set::madd(high, high) : Set::add_madd(high_high, high, high);
      high_low = k == 0 ? Set::madd(high, low) : Set::add_madd(high_low, high, low);
      low_low = k == 0 ? Set::madd(low, low) : Set::add_madd(low_low, low, low);
      if (k % 2 == 0) continue;
      take(to.d_high, d_high);
      take(to.d_low, d_low);
    }
    take_squares(to.high_high, high_high);
    take(to.high_low, high_low);
    take_squares(to.low_low, low_low);
  }

  /// A row of at least a group, part by part; no part is shorter than a group.
  [[gnu::always_inline]] void add_row(Row row, Row soon, State& state, PowerSums& sums) const {
    for (std::size_t from = 0; from < row.size();) {
      const std::size_t left = row.size() - from;
      const std::size_t n = left < kMostOfARow + kGroup ? left : kMostOfARow;
      if (state.pixels + n > kMostPixels) {
        put(totals(state), state.pixels, state.fill, full_scale_, sums);
        state = {};
      }
      add_part(row.data() + from, n, from < soon.size() ? soon.subspan(from) : Row(), state);
      from += n;
    }
  }

  [[gnu::always_inline]] void add_part(const std::uint16_t* pixels, std::size_t n, Row soon, State& state) const {
    std::size_t done = 0;
    for (; done + kGroup <= n; done += kGroup) {
      prefetch(soon, done, done + kGroup);
      add_group<false>(pixels + done, nullptr, state);
    }
    state.pixels += n;
    prefetch(soon, done, soon.size());
    if (done == n) return;
    // The last group overlaps the one before it.
    add_group<true>(pixels + n - kGroup, kMask.data() + (n - done), state);
    state.fill += kGroup - (n - done);
  }

  [[gnu::always_inline]] static std::int32_t over_lanes(const Sums& lanes) {
    std::uint32_t sum = 0;
    for (std::size_t k = 0; k < kLanes / 2; ++k) sum += lanes[k];
    return static_cast<std::int32_t>(sum);
  }

  [[gnu::always_inline]] static std::int64_t over_lanes(const SplitSum& sum) {
    const std::int32_t high = over_lanes(sum.high);
    const auto wrapped = static_cast<std::uint32_t>(over_lanes(sum.wrapped));
    return high * k2To16 + (wrapped - (static_cast<std::uint32_t>(high) << 16U));
  }

  [[gnu::always_inline]] static Totals totals(const State& state) {
    return {.d = over_lanes(state.d),
            .high = over_lanes(state.high),
            .low = over_lanes(state.low),
            .below = over_lanes(Set::madd(state.below, Words{} + std::uint16_t{1})),
            .d_high = over_lanes(state.d_high),
            .d_low = over_lanes(state.d_low),
            .high_high = over_lanes(state.high_high),
            .high_low = over_lanes(state.high_low),
            .low_low = over_lanes(state.low_low)};
  }

  Words threshold_;
  std::uint16_t full_scale_;
};

}  // namespace
}  // namespace gonio::calibration
