#include "calibration/frame_reducer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace gonio::calibration {
namespace {

constexpr std::uint16_t kFullScale = 4095;

using Pixels = std::vector<std::uint16_t>;

/// Raw moments, without maps.
Result<RegionMoments> reduce_frame(const Pixels& pixels, int width, int height, std::uint16_t full_scale,
                                   const ApertureMask& mask) {
  const auto reducer = FrameReducer::prepare(width, height, full_scale, mask);
  if (!reducer) return failure(reducer.error());
  const auto frame = reducer->reduce(pixels, 0.01, 0.0);
  if (!frame) return failure(frame.error());
  return frame->raw;
}

/// A circle that holds a whole frame of 2 x 2 pixels.
constexpr ApertureMask kWhole{.centre_x_px = 0.5, .centre_y_px = 0.5, .radius_px = 1.0};

DetectorMaps maps_2_by_2() {
  DetectorMaps maps;
  maps.width = maps.height = 2;
  maps.version = "v1";
  return maps;
}

Result<ReducedFrame> reduce_2_by_2(const Pixels& pixels, const DetectorMaps& maps, const DetectorModel& noise = {},
                                   double exposure_s = 0.5) {
  const auto reducer = FrameReducer::prepare(2, 2, kFullScale, kWhole, maps, noise);
  if (!reducer) return failure(reducer.error());
  return reducer->reduce(pixels, exposure_s, 0.0);
}

TEST(FrameReducer, GivesTheCentralMomentsOfAHandComputedFrame) {
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

TEST(FrameReducer, TakesExactlyThePixelsWhoseCentresLieInTheCircle) {
  std::vector<std::uint16_t> pixels(5 * 5, 1000);
  for (const std::size_t inside : {7U, 11U, 12U, 13U, 17U}) pixels[inside] = 10;  // the plus sign about (2, 2)

  const auto region =
      reduce_frame(pixels, 5, 5, kFullScale, {.centre_x_px = 2.0, .centre_y_px = 2.0, .radius_px = 1.0});

  ASSERT_TRUE(region) << describe(region.error());
  EXPECT_EQ(region->n, 5U);
  EXPECT_DOUBLE_EQ(region->mean, 10.0);
  EXPECT_DOUBLE_EQ(region->m2, 0.0);
}

TEST(FrameReducer, CountsSaturatedPixelsOnlyInsideTheMask) {
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
TEST(FrameReducer, KeepsAllDigitsOfABrightEvenFrame) {
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

TEST(FrameReducer, RefusesAFrameThatLacksPixels) {
  const std::vector<std::uint16_t> pixels(24, 100);

  const auto region =
      reduce_frame(pixels, 5, 5, kFullScale, {.centre_x_px = 2.0, .centre_y_px = 2.0, .radius_px = 1.0});

  ASSERT_FALSE(region);
  EXPECT_EQ(region.error().code, ErrorCode::IncompleteData);
}

TEST(FrameReducer, RefusesAMaskThatReachesOutOfTheFrameOrHoldsNoPixel) {
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

TEST(FrameReducer, HasNoReducedMeanWithoutMaps) {
  const auto reducer = FrameReducer::prepare(2, 2, kFullScale, kWhole);
  ASSERT_TRUE(reducer);

  const auto frame = reducer->reduce(Pixels{1, 2, 3, 4}, 0.5, 0.0);

  ASSERT_TRUE(frame);
  EXPECT_FALSE(frame->reduced);
  EXPECT_EQ(frame->bad, 0U);
}

TEST(FrameReducer, TakesTheDarkOfTheExposureFromEachPixel) {
  DetectorMaps maps = maps_2_by_2();
  maps.dark_offset_dn = {10, 20, 30, 40};
  maps.dark_rate_dn_per_s = {2, 4, 6, 8};

  const auto frame = reduce_2_by_2({111, 122, 133, 144}, maps);  // 100 above 10 + 1, 20 + 2, 30 + 3, 40 + 4

  ASSERT_TRUE(frame && frame->reduced);
  EXPECT_DOUBLE_EQ(frame->reduced->mean_dn, 100.0);
  EXPECT_DOUBLE_EQ(frame->raw.mean, 127.5);
}

TEST(FrameReducer, DividesByTheFlatField) {
  DetectorMaps maps = maps_2_by_2();
  maps.flat = {0.5F, 1.0F, 1.25F, 2.0F};

  const auto frame = reduce_2_by_2({100, 200, 250, 400}, maps);

  ASSERT_TRUE(frame && frame->reduced);
  EXPECT_NEAR(frame->reduced->mean_dn, 200.0, 1e-5);
}

// a1 x + a2 x^2 with x = net / 4095: at full scale less 1 DN of 4096 / 4095 it is hardly a1 + a2.
TEST(FrameReducer, StraightensEachPixelByItsOwnCurve) {
  DetectorMaps maps = maps_2_by_2();
  maps.linearity_1 = {0.0F, 0.04F, 0.0F, 0.04F};
  maps.linearity_2 = {0.0F, 0.0F, 0.02F, 0.02F};

  const auto frame = reduce_2_by_2({2000, 2000, 2000, 2000}, maps);

  const double x = 2000.0 / 4095.0;
  const double straight = 2000.0 * (1.0 + (2.0 * 0.04 * x + 2.0 * 0.02 * x * x) / 4.0);
  ASSERT_TRUE(frame && frame->reduced);
  EXPECT_NEAR(frame->reduced->mean_dn, straight, 1e-3);
}

TEST(FrameReducer, NeverCountsABadPixel) {
  DetectorMaps maps = maps_2_by_2();
  maps.bad = {0, 1, 0, 0};
  maps.flat = {1.0F, 0.0F, 1.0F, 1.0F};  // what the map has of a bad pixel does not matter

  const auto frame = reduce_2_by_2({10, kFullScale, 20, 30}, maps);

  ASSERT_TRUE(frame && frame->reduced) << "a saturated pixel that is bad saturates nothing";
  EXPECT_EQ(frame->bad, 1U);
  EXPECT_EQ(frame->raw.n, 3U);
  EXPECT_EQ(frame->raw.saturated, 0U);
  EXPECT_DOUBLE_EQ(frame->raw.mean, 20.0);
  EXPECT_NEAR(frame->raw.m2, 200.0 / 3.0, 1e-12);
  EXPECT_DOUBLE_EQ(frame->reduced->mean_dn, 20.0);
}

TEST(FrameReducer, HasNoReducedMeanOfAFrameWithASaturatedPixel) {
  const auto frame = reduce_2_by_2({10, kFullScale, 20, 30}, maps_2_by_2());

  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->raw.saturated, 1U);
  EXPECT_FALSE(frame->reduced);
}

// Four pixels of 400 e- each at 4 e-/DN: 100 DN with shot noise 5 DN and read noise 12 DN, so 13 DN a pixel, 6.5 DN
// their mean.
TEST(FrameReducer, KnowsTheNoiseOfItsMeanByPhotonTransfer) {
  const auto frame =
      reduce_2_by_2({100, 100, 100, 100}, maps_2_by_2(), {.electrons_per_dn = 4.0, .read_noise_dn = 12.0});

  ASSERT_TRUE(frame && frame->reduced);
  EXPECT_NEAR(frame->reduced->u_noise_dn, 6.5, 1e-9);
  EXPECT_EQ(frame->reduced->u_maps_dn, 0.0);
}

// Offset 3 DN, rate 8 DN/s over 0.5 s: 5 DN a pixel of the dark; 12 % of 100 DN of the flat: 13 DN, 6.5 DN of the mean
// of four.
TEST(FrameReducer, PassesTheNoiseOfTheMapsOn) {
  DetectorMaps maps = maps_2_by_2();
  maps.u_dark_offset_dn = 3.0;
  maps.u_dark_rate_dn_per_s = 8.0;
  maps.u_flat = 0.12;

  const auto frame = reduce_2_by_2({100, 100, 100, 100}, maps);

  ASSERT_TRUE(frame && frame->reduced);
  EXPECT_NEAR(frame->reduced->u_maps_dn, 6.5, 1e-9);
}

TEST(FrameReducer, RefusesMapsOfAnotherSizeAndValuesThatItCannotUse) {
  DetectorMaps larger = maps_2_by_2();
  larger.width = 3;
  DetectorMaps torn = maps_2_by_2();
  torn.flat = {1, 1, 1};
  DetectorMaps dead = maps_2_by_2();
  dead.flat = {1, 1, 0, 1};
  DetectorMaps unknown = maps_2_by_2();
  unknown.dark_offset_dn = {0, NAN, 0, 0};

  for (const DetectorMaps& maps : {larger, torn, dead, unknown}) {
    const auto frame = reduce_2_by_2({1, 2, 3, 4}, maps);
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().code, ErrorCode::InvalidInput) << describe(frame.error());
  }
}

TEST(FrameReducer, RefusesAnApertureWithoutAGoodPixel) {
  DetectorMaps maps = maps_2_by_2();
  maps.bad = {1, 1, 1, 1};

  const auto frame = reduce_2_by_2({1, 2, 3, 4}, maps);

  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().code, ErrorCode::OutOfLimits);
}

struct Scale {
  const char* name;
  int bits;
};

class FrameReducerOfBits : public testing::TestWithParam<Scale> {};

// Pixels over the whole scale, against long double sums: the exact integers leave the rounding of the last division
// only; the maps' single precision some 1e-7.
TEST_P(FrameReducerOfBits, AgreesWithSumsInExtendedPrecision) {
  constexpr std::uint64_t kSeed = 20261122;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937_64 chance(kSeed);
  constexpr int kSide = 90;  // chords of all lengths up to 90, none a multiple of a vector
  const auto full_scale = static_cast<std::uint16_t>((1U << static_cast<unsigned>(GetParam().bits)) - 1U);
  DetectorMaps maps;
  maps.width = maps.height = kSide;
  Pixels pixels;
  for (int k = 0; k < kSide * kSide; ++k) {
    pixels.push_back(static_cast<std::uint16_t>(chance() % full_scale));
    maps.dark_offset_dn.push_back(static_cast<float>(chance() % 100) / 8.0F);
    maps.dark_rate_dn_per_s.push_back(static_cast<float>(chance() % 100) / 8.0F);
    maps.flat.push_back(0.75F + static_cast<float>(chance() % 64) / 128.0F);
    maps.linearity_1.push_back(static_cast<float>(chance() % 16) / 1024.0F);
    maps.bad.push_back(chance() % 50 == 0 ? 1 : 0);
  }
  const ApertureMask mask{.centre_x_px = 44.5, .centre_y_px = 44.5, .radius_px = 44.6};

  const auto reducer = FrameReducer::prepare(kSide, kSide, full_scale, mask, maps);
  ASSERT_TRUE(reducer) << describe(reducer.error());
  const auto frame = reducer->reduce(pixels, 0.25, 0.0);

  long double n = 0.0L, sum = 0.0L, reduced = 0.0L;
  const auto each = [&](auto use) {
    for (int k = 0; k < kSide * kSide; ++k) {
      const auto at = static_cast<std::size_t>(k);
      if (maps.bad[at] == 0 && std::hypot(k % kSide - 44.5, k / kSide - 44.5) <= 44.6) use(at);
    }
  };
  each([&](std::size_t at) {
    const long double net =
        pixels[at] - (static_cast<long double>(maps.dark_offset_dn[at]) + 0.25L * maps.dark_rate_dn_per_s[at]);
    n += 1.0L;
    sum += pixels[at];
    reduced += net * (1.0L + maps.linearity_1[at] * net / full_scale) / maps.flat[at];
  });
  long double m2 = 0.0L, m3 = 0.0L, m4 = 0.0L;
  each([&](std::size_t at) {
    const long double d = pixels[at] - sum / n;
    m2 += d * d / n;
    m3 += d * d * d / n;
    m4 += d * d * d * d / n;
  });
  ASSERT_TRUE(frame && frame->reduced);
  EXPECT_EQ(frame->raw.n, static_cast<std::uint32_t>(n));
  EXPECT_NEAR(frame->raw.mean / static_cast<double>(sum / n), 1.0, 1e-15);
  EXPECT_NEAR(frame->raw.m2 / static_cast<double>(m2), 1.0, 1e-14);
  EXPECT_NEAR((frame->raw.m3 - static_cast<double>(m3)) / std::pow(static_cast<double>(m2), 1.5), 0.0, 1e-14);
  EXPECT_NEAR(frame->raw.m4 / static_cast<double>(m4), 1.0, 1e-14);
  EXPECT_NEAR(frame->reduced->mean_dn / static_cast<double>(reduced / n), 1.0, 1e-7);
}

INSTANTIATE_TEST_SUITE_P(Formats, FrameReducerOfBits,
                         testing::Values(Scale{"Mono8", 8}, Scale{"Mono10", 10}, Scale{"Mono12", 12},
                                         Scale{"Mono14", 14}, Scale{"Mono16", 16}),
                         [](const auto& scale) { return scale.param.name; });

// The worst that 256 pixels of a 12-bit block can add up to, at both ends of the scale, and pixels that no 12-bit
// format holds.
TEST(FrameReducer, DoesNotOverflowAtTheEndsOfTheScale) {
  constexpr int kSide = 64;
  const ApertureMask mask{.centre_x_px = 31.5, .centre_y_px = 31.5, .radius_px = 31.9};
  for (const std::uint16_t full_scale : {std::uint16_t{4095}, std::uint16_t{65535}}) {
    for (const std::uint16_t value : {std::uint16_t{0}, std::uint16_t{4094}, std::uint16_t{65535}}) {
      const Pixels pixels(kSide * kSide, value);

      const auto region = reduce_frame(pixels, kSide, kSide, full_scale, mask);

      ASSERT_TRUE(region);
      EXPECT_DOUBLE_EQ(region->mean, value);
      EXPECT_EQ(region->m2, 0.0);
      EXPECT_EQ(region->m4, 0.0);
      EXPECT_EQ(region->saturated, value >= full_scale ? region->n : 0U);
    }
  }
}

}  // namespace
}  // namespace gonio::calibration
