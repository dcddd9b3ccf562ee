#include "calibration/jobs/pixel_sums.h"

#include <gtest/gtest.h>

#include <vector>

namespace gonio::calibration {
namespace {

constexpr ApertureMask kMask{.centre_x_px = 3.0, .centre_y_px = 2.0, .radius_px = 1.0};
constexpr int kWidth = 8;
constexpr int kHeight = 5;

std::vector<std::uint16_t> ramp(std::uint16_t first) {
  std::vector<std::uint16_t> pixels;
  for (int k = 0; k < kWidth * kHeight; ++k) pixels.push_back(static_cast<std::uint16_t>(first + k));
  return pixels;
}
PixelFrame frame_of(const std::vector<std::uint16_t>& pixels, Duration exposure = std::chrono::milliseconds(4)) {
  return {.pixels = pixels, .width = kWidth, .height = kHeight, .exposure = exposure};
}

TEST(PixelSums, OfTheSquareAboutTheApertureAreTheFramesOwn) {
  PixelSums sums;
  const auto first = ramp(100);
  const auto second = ramp(65'000);

  ASSERT_TRUE(add_frame(sums, frame_of(first), kMask));
  ASSERT_TRUE(add_frame(sums, frame_of(second), kMask));

  EXPECT_EQ(sums.box, (PixelBox{.width = 8, .height = 5, .left = 1, .top = 0, .columns = 5, .rows = 5}));
  EXPECT_EQ(sums.frames, 2);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 5; ++x) {
      const double a = 100.0 + 8 * y + x + 1;
      const double b = 65'000.0 + 8 * y + x + 1;
      EXPECT_EQ(sums.sum[static_cast<std::size_t>(5 * y + x)], a + b);
      EXPECT_EQ(sums.sum2[static_cast<std::size_t>(5 * y + x)], a * a + b * b);
    }
  }
}

TEST(PixelSums, AreCutAtTheFramesEdges) {
  const PixelBox box = box_about({.centre_x_px = 0.5, .centre_y_px = 3.5, .radius_px = 3.0}, 6, 5);

  EXPECT_EQ(box, (PixelBox{.width = 6, .height = 5, .left = 0, .top = 0, .columns = 6, .rows = 5}));
}

TEST(PixelSums, TakeNoFrameOfAnotherSizeOrExposure) {
  PixelSums sums;
  const auto pixels = ramp(7);
  ASSERT_TRUE(add_frame(sums, frame_of(pixels), kMask));
  const PixelSums before = sums;

  EXPECT_EQ(add_frame(sums, frame_of(pixels, std::chrono::milliseconds(8)), kMask).error().code,
            ErrorCode::IncompleteData);
  const std::vector<std::uint16_t> torn(kWidth * kHeight - 1, 7);
  EXPECT_EQ(add_frame(sums, frame_of(torn), kMask).error().code, ErrorCode::IncompleteData);
  EXPECT_EQ(sums, before);
}

TEST(PixelStack, CountsTheScatterWithinReadingsAndNotBetweenThem) {
  // One pixel: 10, 12 in one reading, 110, 114 in another. Within: 2 + 8, of two degrees of freedom.
  PixelStack stack;
  for (const auto& [a, b] : {std::pair{10.0, 12.0}, std::pair{110.0, 114.0}}) {
    ASSERT_TRUE(stack.add({.box = {.width = 1, .height = 1, .columns = 1, .rows = 1},
                           .frames = 2,
                           .sum = {a + b},
                           .sum2 = {a * a + b * b}}));
  }

  EXPECT_EQ(stack.frames(), 4);
  EXPECT_EQ(stack.degrees_of_freedom(), 2);
  EXPECT_EQ(stack.mean(0), 61.5);
  EXPECT_EQ(stack.variance(0), 5.0);
}

TEST(PixelStack, RefusesSumsOfAnotherSquareAndDamagedOnes) {
  PixelStack stack;
  PixelSums sums{.box = {.width = 2, .height = 1, .columns = 2, .rows = 1}, .frames = 1, .sum = {1, 2}, .sum2 = {1, 4}};
  ASSERT_TRUE(stack.add(sums));

  PixelSums moved = sums;
  moved.box.left = 1;
  EXPECT_EQ(stack.add(moved).error().code, ErrorCode::IncompleteData);
  sums.sum2.pop_back();
  EXPECT_EQ(stack.add(sums).error().code, ErrorCode::IncompleteData);
  EXPECT_EQ(stack.frames(), 1);
}

}  // namespace
}  // namespace gonio::calibration
