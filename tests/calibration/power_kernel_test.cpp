// Every way to sum powers against the definition, pixel by pixel in 128 bits.
#include "calibration/power_kernel.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace gonio::calibration {
namespace {

constexpr std::uint64_t kSeed = 20261123;
constexpr std::uint16_t kDark = 0, kBright = 65535, kMiddlePixel = 32768;

using Pixels = std::vector<std::uint16_t>;

PowerSums by_definition(std::span<const std::uint16_t> pixels, std::uint16_t full_scale) {
  PowerSums sums;
  for (const std::uint16_t pixel : pixels) {
    const Wide d = Wide{pixel} - 32768;
    sums.n += 1;
    sums.sum1 += d;
    sums.sum2 += d * d;
    sums.sum3 += d * d * d;
    sums.sum4 += d * d * d * d;
    if (pixel >= full_scale) sums.saturated += 1;
  }
  return sums;
}

void expect_equal(const PowerSums& seen, const PowerSums& truth) {
  EXPECT_EQ(seen.n, truth.n);
  EXPECT_TRUE(seen.sum1 == truth.sum1);
  EXPECT_TRUE(seen.sum2 == truth.sum2);
  EXPECT_TRUE(seen.sum3 == truth.sum3);
  EXPECT_TRUE(seen.sum4 == truth.sum4);
  EXPECT_EQ(seen.saturated, truth.saturated);
}

class PowerKernels : public testing::TestWithParam<PowerKernel> {
 protected:
  static void expect_exact(std::span<const std::uint16_t> pixels, std::uint16_t full_scale = 4095) {
    PowerSums sums;
    GetParam().add({&pixels, 1}, {&pixels, 1}, full_scale, sums);
    expect_equal(sums, by_definition(pixels, full_scale));
  }

  static Pixels any(std::size_t n) {
    std::mt19937_64 chance(kSeed);
    Pixels pixels(n);
    for (auto& pixel : pixels) pixel = static_cast<std::uint16_t>(chance());
    return pixels;
  }
};

// As many as fill the widest kernel's vectors, a whole group of them and a cut one.
TEST_P(PowerKernels, SumEveryValueThatAPixelCanHave) {
  constexpr std::int64_t kPixels = 4 * 32 + 20;
  for (unsigned value = 0; value <= kBright; ++value) {
    const Pixels row(kPixels, static_cast<std::uint16_t>(value));
    PowerSums sums;
    PowerSums truth = by_definition(std::span(row).first(1), 4095);
    for (Wide* of : {&truth.sum1, &truth.sum2, &truth.sum3, &truth.sum4}) *of *= kPixels;
    truth.n *= kPixels;
    truth.saturated *= kPixels;
    const std::span<const std::uint16_t> pixels(row);

    GetParam().add({&pixels, 1}, {}, 4095, sums);

    expect_equal(sums, truth);
    if (HasFailure()) FAIL() << "value " << value;
  }
}

// More than one call's worth at both ends of every product: the squares' halves are largest at 0, 128 and 32768.
TEST_P(PowerKernels, KeepTheWorstRowsExact) {
  for (const std::uint16_t one :
       {kDark, std::uint16_t{1}, std::uint16_t{32640}, kMiddlePixel, std::uint16_t{32896}, kBright}) {
    for (const std::uint16_t other : {kDark, std::uint16_t{32640}, kMiddlePixel, kBright}) {
      SCOPED_TRACE(std::to_string(one) + " and " + std::to_string(other));
      Pixels row(70001, one);
      for (std::size_t k = 1; k < row.size(); k += 2) row[k] = other;
      expect_exact(row);
      std::fill(row.begin() + 35000, row.end(), other);
      expect_exact(row);
    }
  }
}

TEST_P(PowerKernels, TakeRowsOfAnyLengthFromAnyAddress) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  const Pixels pixels = any(400);
  for (std::size_t from = 0; from < 33; ++from) {
    for (std::size_t n = 0; n < 300; ++n) expect_exact(std::span(pixels).subspan(from, n));
    if (HasFailure()) FAIL() << "from pixel " << from;
  }
}

TEST_P(PowerKernels, LeaveNoPixelOutWhereALongRowIsCut) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  const Pixels pixels = any(100000);
  for (const std::size_t cut : {16384U, 32768U, 49152U, 98304U}) {
    for (std::size_t n = cut - 70; n < cut + 140; ++n) expect_exact(std::span(pixels).first(n));
  }
}

TEST_P(PowerKernels, CountAsSaturatedFromFullScaleOn) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  const Pixels pixels = any(1003);
  for (const std::uint16_t full_scale : {kDark, std::uint16_t{1}, std::uint16_t{4095}, std::uint16_t{32767},
                                         kMiddlePixel, std::uint16_t{32769}, std::uint16_t{65534}, kBright}) {
    SCOPED_TRACE("full scale " + std::to_string(full_scale));
    expect_exact(pixels, full_scale);
    for (const int beside : {-1, 0, 1})
      expect_exact(Pixels(37, static_cast<std::uint16_t>(full_scale + beside)), full_scale);
  }
}

TEST_P(PowerKernels, AddManyRowsOfUnlikeLengthsToWhatTheSumsHold) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  const Pixels pixels = any(70000);
  std::vector<std::span<const std::uint16_t>> rows;
  for (std::size_t from = 0, n = 1; from + n <= pixels.size(); from += n, n = n * 5 / 4 + 1) {
    rows.push_back(std::span(pixels).subspan(from, n));
  }
  const std::size_t used = static_cast<std::size_t>(rows.back().data() - pixels.data()) + rows.back().size();
  PowerSums sums;

  GetParam().add(std::span(rows).first(5), rows, 4095, sums);
  GetParam().add(std::span(rows).subspan(5), {}, 4095, sums);

  expect_equal(sums, by_definition(std::span(pixels).first(used), 4095));
}

std::vector<PowerKernel> kernels_here() {
  return {power_kernels().begin(), power_kernels().end()};
}

INSTANTIATE_TEST_SUITE_P(Here, PowerKernels, testing::ValuesIn(kernels_here()),
                         [](const auto& kernel) { return std::string(kernel.param.name); });

TEST(PowerKernelList, AlwaysEndsWithThePlainOne) {
  ASSERT_FALSE(power_kernels().empty());
  EXPECT_EQ(power_kernels().back().name, "plain");
}

}  // namespace
}  // namespace gonio::calibration
