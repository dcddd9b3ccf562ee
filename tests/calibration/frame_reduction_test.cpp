#include "calibration/frame_reduction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace gonio::calibration {
namespace {

constexpr std::uint16_t kFullScale = 4095;

TEST(FrameReduction, GivesTheCentralMomentsOfAHandComputedFrame) {
  // 2 x 2 pixels, all inside: mean 3, deviations -2, -1, 0, 3.
  const std::vector<std::uint16_t> pixels = {1, 2, 3, 6};

  const auto region =
      reduce_frame(pixels, 2, 2, kFullScale, {.centre_x_px = 0.5, .centre_y_px = 0.5, .radius_px = 1.0});

  ASSERT_TRUE(region) << describe(region.error());
  EXPECT_EQ(region->n, 4U);
  EXPECT_DOUBLE_EQ(region->mean, 3.0);
  EXPECT_DOUBLE_EQ(region->m2, 14.0 / 4.0);
  EXPECT_DOUBLE_EQ(region->m3, 18.0 / 4.0);
  EXPECT_DOUBLE_EQ(region->m4, 98.0 / 4.0);
  EXPECT_EQ(region->saturated, 0U);
}

TEST(FrameReduction, TakesExactlyThePixelsWhoseCentresLieInTheCircle) {
  std::vector<std::uint16_t> pixels(5 * 5, 1000);
  for (const std::size_t inside : {7U, 11U, 12U, 13U, 17U}) pixels[inside] = 10;  // the plus sign about (2, 2)

  const auto region =
      reduce_frame(pixels, 5, 5, kFullScale, {.centre_x_px = 2.0, .centre_y_px = 2.0, .radius_px = 1.0});

  ASSERT_TRUE(region) << describe(region.error());
  EXPECT_EQ(region->n, 5U);
  EXPECT_DOUBLE_EQ(region->mean, 10.0);
  EXPECT_DOUBLE_EQ(region->m2, 0.0);
}

TEST(FrameReduction, CountsSaturatedPixelsOnlyInsideTheMask) {
  std::vector<std::uint16_t> pixels(5 * 5, 100);
  pixels[12] = kFullScale;
  pixels[11] = kFullScale - 1;
  pixels[0] = kFullScale;

  const auto region =
      reduce_frame(pixels, 5, 5, kFullScale, {.centre_x_px = 2.0, .centre_y_px = 2.0, .radius_px = 1.0});

  ASSERT_TRUE(region) << describe(region.error());
  EXPECT_EQ(region->saturated, 1U);
}

// Moments of a frame near full scale with one DN of noise and a hot first pixel, against the plain two-pass formula in
// extended precision: sums of raw powers would keep no digit of m4.
TEST(FrameReduction, KeepsAllDigitsOfABrightEvenFrame) {
  constexpr std::uint64_t kSeed = 20260101;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937_64 chance(kSeed);
  constexpr int kSide = 64;
  std::vector<std::uint16_t> pixels;
  for (int k = 0; k < kSide * kSide; ++k) pixels.push_back(static_cast<std::uint16_t>(60000 + chance() % 4));
  const ApertureMask mask{.centre_x_px = 31.5, .centre_y_px = 31.5, .radius_px = 31.0};

  const auto region = reduce_frame(pixels, kSide, kSide, 65535, mask);

  ASSERT_TRUE(region) << describe(region.error());
  std::vector<long double> inside;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      if (std::hypot(x - 31.5, y - 31.5) <= 31.0) inside.push_back(pixels[static_cast<std::size_t>(y * kSide + x)]);
    }
  }
  const auto n = static_cast<long double>(inside.size());
  long double mean = 0.0L, m2 = 0.0L, m3 = 0.0L, m4 = 0.0L;
  for (const long double p : inside) mean += p / n;
  for (const long double p : inside) {
    m2 += powl(p - mean, 2) / n;
    m3 += powl(p - mean, 3) / n;
    m4 += powl(p - mean, 4) / n;
  }
  EXPECT_EQ(region->n, inside.size());
  EXPECT_NEAR(region->mean, static_cast<double>(mean), 1e-10);
  EXPECT_NEAR(region->m2, static_cast<double>(m2), 1e-11);
  EXPECT_NEAR(region->m3, static_cast<double>(m3), 1e-10);
  EXPECT_NEAR(region->m4, static_cast<double>(m4), 1e-10);
}

TEST(FrameReduction, RefusesAFrameThatLacksPixels) {
  const std::vector<std::uint16_t> pixels(24, 100);

  const auto region =
      reduce_frame(pixels, 5, 5, kFullScale, {.centre_x_px = 2.0, .centre_y_px = 2.0, .radius_px = 1.0});

  ASSERT_FALSE(region);
  EXPECT_EQ(region.error().code, ErrorCode::IncompleteData);
}

TEST(FrameReduction, RefusesAMaskThatReachesOutOfTheFrameOrHoldsNoPixel) {
  const std::vector<std::uint16_t> pixels(25, 100);

  const auto beyond =
      reduce_frame(pixels, 5, 5, kFullScale, {.centre_x_px = 4.0, .centre_y_px = 2.0, .radius_px = 1.0});
  const auto between =
      reduce_frame(pixels, 5, 5, kFullScale, {.centre_x_px = 2.5, .centre_y_px = 2.5, .radius_px = 0.1});
  const auto nothing =
      reduce_frame(pixels, 5, 5, kFullScale, {.centre_x_px = 2.0, .centre_y_px = 2.0, .radius_px = 0.0});

  for (const auto& region : {beyond, between, nothing}) {
    ASSERT_FALSE(region);
    EXPECT_EQ(region.error().code, ErrorCode::OutOfLimits);
  }
}

}  // namespace
}  // namespace gonio::calibration
