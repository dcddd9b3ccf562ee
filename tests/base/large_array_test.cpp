#include "base/large_array.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>

namespace gonio {
namespace {

TEST(LargeArray, BeginsOnAPageOfItsOwnWhereItIsLarge) {
  const LargeArray<double> numbers((std::size_t{4} << 20U) / sizeof(double));

  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(numbers.data()) % (std::size_t{2} << 20U), 0U);
}

TEST(LargeArray, TakesPagesThatWereGivenBack) {
  constexpr std::size_t kNumbers = (std::size_t{6} << 20U) / sizeof(double);
  const double* before = nullptr;
  {
    const LargeArray<double> first(kNumbers);
    before = first.data();
  }
  const LargeArray<double> second(kNumbers, 2.0);

  EXPECT_EQ(second.data(), before);
  EXPECT_EQ(second.back(), 2.0);
}

#if defined(__SANITIZE_ADDRESS__)
TEST(LargeArrayDeathTest, IsSeenByTheAddressSanitizerWhereItIsOver) {
  constexpr std::size_t kNumbers = (std::size_t{5} << 20U) / sizeof(double) + 1;
  std::optional<LargeArray<double>> numbers(kNumbers);
  const volatile double* const first = numbers->data();
  EXPECT_DEATH((void)first[kNumbers], "AddressSanitizer");
  numbers.reset();
  EXPECT_DEATH((void)first[0], "AddressSanitizer");
}
#endif

TEST(LargeArray, KeepsItsElementsThroughGrowthAndCopies) {
  LargeArray<int> grown;
  for (int n = 0; n < 1'000'000; ++n) grown.push_back(n);
  const LargeArray<int> copy = grown;
  grown.resize(1);

  for (int n = 0; n < 1'000'000; ++n) ASSERT_EQ(copy[static_cast<std::size_t>(n)], n);
  EXPECT_EQ(grown, LargeArray<int>{0});
}

TEST(LargeArray, TakesElementsThatHaveInitialisersOfTheirOwn) {
  struct Point {
    double value = 3.0;
    int index = 7;
  };
  LargeArray<Point> points;
  points.push_back({.value = 1.0, .index = 2});
  points.resize(2);
  points[1] = {};

  EXPECT_EQ(points[0].index, 2);
  EXPECT_EQ(points[1].value, 3.0);
}

}  // namespace
}  // namespace gonio
