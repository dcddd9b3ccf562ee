#include "reflectance/sampling/random_stream.h"

#include <gtest/gtest.h>

#include <set>

namespace gonio::reflectance {
namespace {

// The authors' known answers: file kat_vectors of Random123, lines "philox4x32 10".
static_assert(philox4x32({0, 0, 0, 0}, {0, 0}) == RandomBlock{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
static_assert(philox4x32({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}) ==
              RandomBlock{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
static_assert(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}) ==
              RandomBlock{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});

TEST(RandomStream, KeysTheGeneratorBySeedAndCountsByIndex) {
  const RandomStream stream(0x299f31d0a4093822);
  EXPECT_EQ(stream.block(0x85a308d3243f6a88), philox4x32({0x243f6a88, 0x85a308d3, 0, 0}, {0xa4093822, 0x299f31d0}));
  EXPECT_EQ(stream.deeper().block(7), philox4x32({7, 0, 1, 0}, {0xa4093822, 0x299f31d0}));
}

TEST(RandomStream, GivesOtherDrawsForAnotherSeedIndexOrDepth) {
  std::set<RandomBlock> blocks;
  for (const std::uint64_t seed : {0ULL, 1ULL, 1ULL << 32U}) {
    for (const std::uint64_t index : {0ULL, 1ULL, 1ULL << 32U}) {
      blocks.insert(RandomStream(seed).block(index));
      blocks.insert(RandomStream(seed).deeper().block(index));
    }
  }
  EXPECT_EQ(blocks.size(), 18U);
}

TEST(RandomStream, NeverGivesTheEndsOfTheUnitInterval) {
  EXPECT_GT(open_unit(0), 0.0);
  EXPECT_LT(open_unit(0xffffffff), 1.0);
  EXPECT_EQ(open_unit(0, 0), 0x1p-53);
  EXPECT_EQ(open_unit(0xffffffff, 0xffffffff), 1.0 - 0x1p-53);
}

TEST(RandomStream, FillsTheUnitSquareEvenly) {
  constexpr int kDraws = 100000;
  constexpr std::size_t kCells = 10;
  std::vector<double> counts(kCells * kCells);
  for (std::uint64_t k = 0; k < kDraws; ++k) {
    const UnitPoint p = RandomStream(1).point(k);
    counts[static_cast<std::size_t>(p.u * kCells) * kCells + static_cast<std::size_t>(p.v * kCells)] += 1.0;
  }
  double chi_square = 0.0;
  constexpr double kExpected = kDraws / static_cast<double>(kCells * kCells);
  for (const double count : counts) chi_square += (count - kExpected) * (count - kExpected) / kExpected;
  EXPECT_LT(chi_square, 99.0 + 4.0 * 14.1);  // 99 degrees of freedom
}

}  // namespace
}  // namespace gonio::reflectance
