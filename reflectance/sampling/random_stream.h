#pragma once

#include <array>
#include <cstdint>

#include "reflectance/sampling/direction_sample.h"

namespace gonio::reflectance {

/// What one call of the generator gives: 128 random bits.
using RandomBlock = std::array<std::uint32_t, 4>;

/// Philox 4x32-10 of Salmon, Moraes, Dror and Shaw, "Parallel random numbers: as easy as 1, 2, 3" (SC11, 2011): a
/// bijection of the counter, ten rounds deep, chosen by the key.
[[nodiscard, gnu::always_inline]] constexpr RandomBlock philox4x32(RandomBlock counter,
                                                                   std::array<std::uint32_t, 2> key) {
  constexpr std::uint64_t kMultiplier0 = 0xD2511F53;
  constexpr std::uint64_t kMultiplier1 = 0xCD9E8D57;
  constexpr std::uint32_t kWeyl0 = 0x9E3779B9;  // golden ratio
  constexpr std::uint32_t kWeyl1 = 0xBB67AE85;  // sqrt(3) - 1
  constexpr int kRounds = 10;
  for (int round = 0; round < kRounds; ++round) {
    const std::uint64_t p0 = kMultiplier0 * counter[0];
    const std::uint64_t p1 = kMultiplier1 * counter[2];
    counter = {static_cast<std::uint32_t>(p1 >> 32U) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(p1),
               static_cast<std::uint32_t>(p0 >> 32U) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(p0)};
    key = {key[0] + kWeyl0, key[1] + kWeyl1};
  }
  return counter;
}

/// A number in (0, 1), both ends excluded, of 52 random bits.
[[nodiscard]] constexpr double open_unit(std::uint32_t high, std::uint32_t low) {
  const std::uint64_t bits = (std::uint64_t{high} << 32U) | low;
  return (static_cast<double>(bits >> 12U) + 0.5) * 0x1p-52;
}
/// The same of 32 bits.
[[nodiscard]] constexpr double open_unit(std::uint32_t bits) {
  return (static_cast<double>(bits) + 0.5) * 0x1p-32;
}

/// Chance as a function: draw k of a seed is the same whoever asks for it, in what order, on what thread. Nothing is
/// carried from one draw to the next. A plain value; threads: any.
class RandomStream {
 public:
  explicit constexpr RandomStream(std::uint64_t seed) : RandomStream(seed, 0) {}

  /// 128 bits of their own for each of 2^64 indices.
  [[nodiscard, gnu::always_inline]] constexpr RandomBlock block(std::uint64_t index) const {
    return philox4x32({low(index), high(index), depth_, 0}, {low(seed_), high(seed_)});
  }
  /// The same bits as two numbers, neither 0 nor 1.
  [[nodiscard]] constexpr UnitPoint point(std::uint64_t index) const {
    const RandomBlock b = block(index);
    return {.u = open_unit(b[0], b[1]), .v = open_unit(b[2], b[3])};
  }

  /// A stream that shares no draw with this one: for a choice that is made after another of the same index.
  [[nodiscard]] constexpr RandomStream deeper() const { return {seed_, depth_ + 1}; }

  [[nodiscard]] constexpr std::uint64_t seed() const { return seed_; }

 private:
  constexpr RandomStream(std::uint64_t seed, std::uint32_t depth) : seed_(seed), depth_(depth) {}
  static constexpr std::uint32_t low(std::uint64_t x) { return static_cast<std::uint32_t>(x); }
  static constexpr std::uint32_t high(std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32U); }

  std::uint64_t seed_;
  std::uint32_t depth_;
};

}  // namespace gonio::reflectance
