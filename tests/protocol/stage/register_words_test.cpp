// Words written by hand: two's complement, and the order of the halves of a 32-bit value.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

#include "protocol/stage/register_map.h"

namespace gonio::stage {
namespace {

struct Case {
  Register reg;
  std::int64_t value;
  std::vector<std::uint16_t> words;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all{
      {{10, 1, false, false}, 0, {0x0000}},
      {{10, 1, false, false}, 65535, {0xFFFF}},
      {{10, 1, true, false}, -1, {0xFFFF}},
      {{10, 1, true, false}, -32768, {0x8000}},
      {{10, 1, true, false}, 32767, {0x7FFF}},
      {{10, 2, false, false}, 1, {0x0000, 0x0001}},
      {{10, 2, false, true}, 1, {0x0001, 0x0000}},
      {{10, 2, false, false}, 0x12345678, {0x1234, 0x5678}},
      {{10, 2, false, true}, 0x12345678, {0x5678, 0x1234}},
      {{10, 2, false, false}, 4294967295, {0xFFFF, 0xFFFF}},
      {{10, 2, true, false}, -1, {0xFFFF, 0xFFFF}},
      {{10, 2, true, false}, -2, {0xFFFF, 0xFFFE}},
      {{10, 2, true, true}, -2, {0xFFFE, 0xFFFF}},
      {{10, 2, true, false}, std::numeric_limits<std::int32_t>::min(), {0x8000, 0x0000}},
      {{10, 2, true, false}, std::numeric_limits<std::int32_t>::max(), {0x7FFF, 0xFFFF}},
  };
  return all;
}

TEST(RegisterWords, AreReadBySignAndWordOrder) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.value);

    EXPECT_EQ(decode(c.words, 10, c.reg), c.value);
  }
}

TEST(RegisterWords, AreWrittenBySignAndWordOrder) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.value);
    std::vector<std::uint16_t> words(c.words.size(), 0xAAAA);

    encode(words, 10, c.reg, c.value);

    EXPECT_EQ(words, c.words);
  }
}

TEST(RegisterWords, AreTakenFromTheirPlaceInALargerBlock) {
  const std::array<std::uint16_t, 5> block{0x1111, 0x2222, 0xFFFF, 0xFFF0, 0x5555};

  EXPECT_EQ(decode(block, 100, {102, 2, true, false}), -16);
  EXPECT_EQ(decode(block, 100, {104, 1, false, false}), 0x5555);
}

TEST(RegisterWords, LeaveTheirNeighboursAlone) {
  std::array<std::uint16_t, 4> block{7, 7, 7, 7};

  encode(block, 20, {21, 2, true, false}, -3);

  EXPECT_EQ(block, (std::array<std::uint16_t, 4>{7, 0xFFFF, 0xFFFD, 7}));
}

}  // namespace
}  // namespace gonio::stage
