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
// vectors' of the others, fit 32 bits; then they go into a SplitSum. All sums stay in registers from row to row.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "calibration/power_kernel.h"

namespace gonio::calibration {
namespace {

// So few that the sums below, over all lanes, stay inside of 32 bits: |d| 2^15 in each of 2^15 pixels.
constexpr std::size_t kMostPixels = 32768;
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

/// The cache lines of the pixels from `from` to before `to`, as far as there are such.
[[gnu::always_inline]] inline void prefetch(std::span<const std::uint16_t> soon, std::size_t from, std::size_t to) {
  if (from >= soon.size()) return;
  for (std::size_t at = from; at < to && at < soon.size(); at += kCacheLine) __builtin_prefetch(soon.data() + at);
  if (to >= soon.size()) __builtin_prefetch(&soon.back());  // its line may be one that no step met
}

/// `Set` is an instruction set: its vectors of unsigned 16 and 32 bits `Words` and `Sums`, and of signed words
///   madd(a, b)                   products, added in pairs to Sums,
///   add_madd(to, a, b)           the same added to `to`,
///   mulhrs(a, b)                 (a b + 2^14) >> 15,
///   count_less(counts, a, b)     `counts`, one more where a < b.
template <class Set>
class VectorSummer {
 public:
  explicit VectorSummer(std::uint16_t full_scale)
      : threshold_(Words{} + static_cast<std::uint16_t>(full_scale - kPowerShift)), full_scale_(full_scale) {}

  void add(PixelRows rows, PixelRows soon, PowerSums& sums) const {
    for (std::size_t from = 0; from < rows.size();) {
      const std::size_t some = rows_at_once(rows.subspan(from));
      if (some == 0)
        add_long(rows[from], sums);
      else
        add_some(rows.subspan(from, some), soon.subspan(std::min(from, soon.size())), sums);
      from += std::max<std::size_t>(some, 1);
    }
  }

 private:
  using Row = std::span<const std::uint16_t>;
  using Words = typename Set::Words;
  using Sums = typename Set::Sums;
  static constexpr std::size_t kLanes = sizeof(Words) / sizeof(std::uint16_t);
  static constexpr std::size_t kGroup = 4 * kLanes;  // pixels

  // Read from pixel n on: 0 for all but the last n lanes, which are all ones.
  static constexpr auto kLastLanes = [] {
    std::array<std::uint16_t, 2 * kLanes> mask{};
    for (std::size_t k = kLanes; k < mask.size(); ++k) mask[k] = 0xFFFF;
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

  /// Of two or four vectors, not yet in a SplitSum.
  struct Products {
    Sums d_high{}, d_low{}, high_high{}, high_low{}, low_low{};
  };

  /// How many of the first rows fit the sums of a State; 0 when the first is too long.
  static std::size_t rows_at_once(PixelRows rows) {
    std::size_t pixels = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      pixels += rows[k].size();
      if (pixels > kMostPixels) return k;
    }
    return rows.size();
  }

  void add_long(Row row, PowerSums& sums) const {
    for (std::size_t from = 0; from < row.size(); from += kMostPixels) {
      const Row piece = row.subspan(from, std::min(kMostPixels, row.size() - from));
      add_some({&piece, 1}, {}, sums);
    }
  }

  /// Rows that fit the sums of a State.
  void add_some(PixelRows rows, PixelRows soon, PowerSums& sums) const {
    State state;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (rows[k].size() >= kLanes) add_row(rows[k], k < soon.size() ? soon[k] : Row(), state);
    }
    put(totals(state), state.pixels, state.fill, full_scale_, sums);
    // Apart from the others: a call in the loop above would send all its sums to memory in each row.
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (rows[k].size() < kLanes) power_kernels().back().add(rows.subspan(k, 1), {}, full_scale_, sums);
    }
  }

  [[gnu::always_inline]] static Words load(const std::uint16_t* at) {
    Words words;
    std::memcpy(&words, at, sizeof words);
    return words;
  }

  /// Words of 0 and 1 in turn: madd with them is the upper, signed half of each 32 bits.
  [[gnu::always_inline]] static void take(SplitSum& sum, Sums terms) {
    sum.wrapped += terms;
    sum.high = Set::add_madd(sum.high, reinterpret_cast<Words>(terms), reinterpret_cast<Words>(Sums{} + (1U << 16U)));
  }

  /// Four vectors of squares may reach 2^31, which has no sign.
  [[gnu::always_inline]] static void take_squares(SplitSum& sum, Sums terms) {
    sum.wrapped += terms;
    sum.high += terms >> 16;
  }

  [[gnu::always_inline]] void add_vector(Words d, Products& products, State& to) const {
    const Words ones = Words{} + std::uint16_t{1};
    const Words rounded = Set::mulhrs(d, d);  // d^2 / 2^15; 2^15 has lost its sign, which the next line does not mind
    const Words high = rounded - std::uint16_t{1 << 14};
    const Words low = d * d - (rounded << 15);
    to.below = Set::count_less(to.below, d, threshold_);
    to.d = Set::add_madd(to.d, d, ones);
    to.high = Set::add_madd(to.high, high, ones);
    to.low = Set::add_madd(to.low, low, ones);
    products.d_high = Set::add_madd(products.d_high, d, high);
    products.d_low = Set::add_madd(products.d_low, d, low);
    products.high_high = Set::add_madd(products.high_high, high, high);
    products.high_low = Set::add_madd(products.high_low, high, low);
    products.low_low = Set::add_madd(products.low_low, low, low);
  }

  /// `n` pixels that need `vectors` (1 to 4) of them. Where they do not fill the last it is read back from the end,
  /// over pixels that are summed already and count as d = 0.
  template <std::size_t vectors, bool fills_last>
  [[gnu::always_inline]] void add_group(const std::uint16_t* pixels, std::size_t n, State& to) const {
    Products products;
    for (std::size_t k = 0; k < vectors; ++k) {
      const bool is_last = k + 1 == vectors;
      if (is_last && !fills_last) {
        const Words d = load(pixels + n - kLanes) ^ std::uint16_t{kPowerShift};
        add_vector(d & load(kLastLanes.data() + (n - k * kLanes)), products, to);
      } else {
        add_vector(load(pixels + k * kLanes) ^ std::uint16_t{kPowerShift}, products, to);
      }
      if (k % 2 == 0 && !is_last) continue;
      take(to.d_high, products.d_high);
      take(to.d_low, products.d_low);
      products.d_high = products.d_low = Sums{};
    }
    take_squares(to.high_high, products.high_high);
    take(to.high_low, products.high_low);
    take_squares(to.low_low, products.low_low);
    if (!fills_last) to.fill += vectors * kLanes - n;
  }

  /// A row of at least a vector.
  [[gnu::always_inline]] void add_row(Row row, Row soon, State& state) const {
    const std::uint16_t* const pixels = row.data();
    const std::size_t n = row.size();
    std::size_t done = 0;
    for (; done + kGroup <= n; done += kGroup) {
      prefetch(soon, done, done + kGroup);
      add_group<4, true>(pixels + done, kGroup, state);
    }
    prefetch(soon, done, soon.size());
    state.pixels += n;
    const std::size_t left = n - done;
    if (left > 3 * kLanes) {
      add_group<4, false>(pixels + done, left, state);
    } else if (left > 2 * kLanes) {
      add_group<3, false>(pixels + done, left, state);
    } else if (left > kLanes) {
      add_group<2, false>(pixels + done, left, state);
    } else if (left > 0) {
      add_group<1, false>(pixels + done, left, state);
    }
  }

  // By value: a reference would keep the sums in memory.
  [[gnu::always_inline]] static std::int32_t over_lanes(Sums lanes) {
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
