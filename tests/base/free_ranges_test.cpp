#include "base/free_ranges.h"

#include <gtest/gtest.h>

#include <array>

namespace gonio {
namespace {

struct Memory {
  std::array<std::byte, 100> bytes{};
  FreeRanges free;
  std::byte* at(std::size_t n) { return bytes.data() + n; }
};

TEST(FreeRanges, JoinsThoseThatTouch) {
  Memory m;
  m.free.add(m.at(0), 10);
  m.free.add(m.at(20), 10);
  EXPECT_EQ(m.free.take(30), nullptr);

  m.free.add(m.at(10), 10);

  EXPECT_EQ(m.free.bytes(), 30U);
  EXPECT_EQ(m.free.take(30), m.at(0));
  EXPECT_EQ(m.free.bytes(), 0U);
}

TEST(FreeRanges, TakesTheSmallestThatHasRoom) {
  Memory m;
  m.free.add(m.at(0), 30);
  m.free.add(m.at(40), 10);
  m.free.add(m.at(60), 20);

  EXPECT_EQ(m.free.take(15), m.at(60));
  EXPECT_EQ(m.free.take(10), m.at(40));
  EXPECT_EQ(m.free.take(6), m.at(0));
}

TEST(FreeRanges, KeepsTheRestOfWhatWasLonger) {
  Memory m;
  m.free.add(m.at(0), 30);

  EXPECT_EQ(m.free.take(10), m.at(0));
  EXPECT_EQ(m.free.take(20), m.at(10));
  EXPECT_EQ(m.free.take(1), nullptr);
}

}  // namespace
}  // namespace gonio
