// Pixels whose truth is drawn here, read out with Poisson and normal noise and rounded to digits, as a camera does.
#include "calibration/jobs/detector_map_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <vector>

#include "calibration/detector_maps.h"
#include "calibration/frame_reducer.h"

namespace gonio::calibration {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr int kSide = 64;
constexpr ApertureMask kMask{.centre_x_px = 31.0, .centre_y_px = 32.0, .radius_px = 25.0};
constexpr double kElectronsPerDn = 2.0;

struct Pixel {
  double offset = 100.0;  // DN
  double rate = 40.0;     // DN/s
  double response = 1.0;
  double read_noise = 2.0;  // DN
};

class Camera {
 public:
  explicit Camera(std::uint64_t seed, double offset_sigma = 3.0, double rate_sigma = 8.0, double flat_sigma = 0.02)
      : chance_(seed) {
    for (std::size_t k = 0; k < std::size_t{kSide} * kSide; ++k) {
      pixels_.push_back({.offset = 100.0 + offset_sigma * normal_(chance_),
                         .rate = 40.0 + rate_sigma * normal_(chance_),
                         .response = 1.0 + flat_sigma * normal_(chance_)});
    }
  }
  Pixel& at(int x, int y) { return pixels_[static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x)]; }
  [[nodiscard]] const std::vector<Pixel>& pixels() const { return pixels_; }
  double slope = 0.0;  ///< of the light across the field, relative to its mean, per width

  // One reading of `frames`, all with one shift of the dark level.
  PixelSums read(Duration exposure, int frames, double light_dn_per_s = 0.0, double shift_dn = 0.0) {
    PixelSums sums;
    for (int f = 0; f < frames; ++f) {
      const std::vector<std::uint16_t> frame = expose(exposure, light_dn_per_s, shift_dn);
      EXPECT_TRUE(add_frame(sums, {.pixels = frame, .width = kSide, .height = kSide, .exposure = exposure}, kMask));
    }
    return sums;
  }
  std::vector<std::uint16_t> expose(Duration exposure, double light_dn_per_s, double shift_dn = 0.0) {
    std::vector<std::uint16_t> frame;
    for (std::size_t k = 0; k < pixels_.size(); ++k) {
      const Pixel& p = pixels_[k];
      const double x = static_cast<double>(k % kSide) / kSide - 0.5;
      const double light = light_dn_per_s * p.response * (1.0 + slope * x);
      std::poisson_distribution<int> electrons((p.rate + light) * in_seconds(exposure) * kElectronsPerDn);
      const double dn = p.offset + shift_dn + electrons(chance_) / kElectronsPerDn + p.read_noise * normal_(chance_);
      frame.push_back(static_cast<std::uint16_t>(std::clamp(std::round(dn), 0.0, 4095.0)));
    }
    return frame;
  }

 private:
  std::mt19937_64 chance_;
  std::normal_distribution<double> normal_;
  std::vector<Pixel> pixels_;
};

PixelStack stack_of(const std::vector<PixelSums>& readings) {
  PixelStack stack;
  for (const PixelSums& one : readings) EXPECT_TRUE(stack.add(one));
  return stack;
}
bool is_inside(std::size_t pixel) {
  const double x = static_cast<double>(pixel % kSide) - kMask.centre_x_px;
  const double y = static_cast<double>(pixel / kSide) - kMask.centre_y_px;
  return x * x + y * y <= kMask.radius_px * kMask.radius_px;
}
double value_of(const FoundValues& found, const std::string& name) {
  const auto place = found.place_of(name);
  EXPECT_TRUE(place) << name;
  return place ? found.values[*place].value : -1.0;
}

/// Of (found - true) / u over the aperture.
struct Agreement {
  double rms = 0.0;
  double within_2u = 0.0;
  int pixels = 0;
};
Agreement agreement(const std::vector<float>& map, double u, const Camera& camera,
                    const std::function<double(const Pixel&)>& truth) {
  Agreement all;
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (!is_inside(k)) continue;
    const double z = (static_cast<double>(map[k]) - truth(camera.pixels()[k])) / u;
    all.rms += z * z;
    all.within_2u += std::abs(z) <= 2.0 ? 1.0 : 0.0;
    ++all.pixels;
  }
  all.rms = std::sqrt(all.rms / all.pixels);
  all.within_2u /= all.pixels;
  return all;
}
// Of some 1960 independent pixels the RMS scatters by 1.6 %, the share within 2 u by 0.5 %: four of each, and the
// half digit that a u by shot noise of the mean pixel is off for pixels that are not the mean.
void expect_true_u(const Agreement& found) {
  EXPECT_GT(found.pixels, 1900);
  EXPECT_NEAR(found.rms, 1.0, 0.08);
  EXPECT_NEAR(found.within_2u, 0.9545, 0.025);
}

std::vector<PixelStack> darks_of(Camera& camera, int frames) {
  std::vector<PixelStack> darks;
  for (const Duration exposure : {milliseconds(1), milliseconds(64), milliseconds(512)}) {
    darks.push_back(stack_of({camera.read(exposure, frames), camera.read(exposure, frames, 0.0, 1.0)}));
  }
  return darks;
}

TEST(DarkMap, FindsOffsetAndRateOfEachPixelWithinItsUncertainty) {
  Camera camera(1);
  const auto maps = fit_dark_map(darks_of(camera, 16), kMask);

  ASSERT_TRUE(maps) << describe(maps.error());
  ASSERT_EQ(maps->dark.layers.size(), 2U);
  // The second visit stood 1 DN higher, for all pixels and exposures: half of it is in each offset.
  expect_true_u(
      agreement(maps->dark.layers[0], maps->dark.u[0], camera, [](const Pixel& p) { return p.offset + 0.5; }));
  expect_true_u(agreement(maps->dark.layers[1], maps->dark.u[1], camera, [](const Pixel& p) { return p.rate; }));
  EXPECT_EQ(value_of(maps->found, "bad_pixels"), 0.0);
  EXPECT_NEAR(value_of(maps->found, "dark_offset_dn"), 100.5, 0.4);
  EXPECT_NEAR(value_of(maps->found, "dark_rate_dn_per_s"), 40.0, 1.0);
  EXPECT_FALSE(maps->flat);
}

TEST(DarkMap, AtOneExposureIsAnOffsetAndSaysSo) {
  Camera camera(2);
  const auto maps = fit_dark_map({stack_of({camera.read(milliseconds(64), 32)})}, kMask);

  ASSERT_TRUE(maps) << describe(maps.error());
  ASSERT_EQ(maps->dark.layers.size(), 1U);
  expect_true_u(agreement(maps->dark.layers[0], maps->dark.u[0], camera,
                          [](const Pixel& p) { return p.offset + 0.064 * p.rate; }));
  EXPECT_THAT(maps->found.note, HasSubstr("no rate"));
}

TEST(DarkMap, HoldsNothingBeyondTheApertureThatAReductionWouldTake) {
  Camera camera(3);
  const auto maps = fit_dark_map(darks_of(camera, 4), kMask);
  ASSERT_TRUE(maps) << describe(maps.error());
  DetectorMaps detector{.width = kSide, .height = kSide, .dark_offset_dn = maps->dark.layers[0]};
  const auto prepare = [&](const ApertureMask& mask) {
    return FrameReducer::prepare(kSide, kSide, 4095, mask, std::optional(detector));
  };

  EXPECT_TRUE(prepare(kMask));
  ApertureMask moved = kMask;
  moved.centre_x_px += 3.0;
  EXPECT_EQ(prepare(moved).error().code, ErrorCode::InvalidInput);
}

TEST(DarkMap, CountsHotAndNoisyPixelsByCauseAndNoOthers) {
  Camera camera(4);
  camera.at(31, 32).rate = 2000.0;
  camera.at(20, 30).offset = 180.0;
  camera.at(40, 40).read_noise = 9.0;
  camera.at(2, 2).rate = 3000.0;  // beyond the aperture
  const auto maps = fit_dark_map(darks_of(camera, 32), kMask);

  ASSERT_TRUE(maps) << describe(maps.error());
  std::set<std::pair<int, int>> bad;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      if (maps->bad.layers[0][static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x)] != 0.0F) {
        bad.insert({x, y});
      }
    }
  }
  EXPECT_EQ(bad, (std::set<std::pair<int, int>>{{31, 32}, {20, 30}, {40, 40}}));
  EXPECT_EQ(value_of(maps->found, "bad_pixels"), 3.0);
  EXPECT_EQ(value_of(maps->found, "bad_hot"), 2.0);
  EXPECT_GE(value_of(maps->found, "bad_noisy"), 1.0);
  EXPECT_EQ(value_of(maps->found, "bad_dead"), 0.0);
}

TEST(DarkMap, NeedsTwoFramesOfAReading) {
  Camera camera(5);

  EXPECT_EQ(fit_dark_map({}, kMask).error().code, ErrorCode::IncompleteData);
  EXPECT_EQ(fit_dark_map({stack_of({camera.read(milliseconds(1), 1)})}, kMask).error().code, ErrorCode::IncompleteData);
}

double mean_response(const Camera& camera) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t k = 0; k < camera.pixels().size(); ++k) {
    if (!is_inside(k)) continue;
    sum += camera.pixels()[k].response;
    ++count;
  }
  return sum / count;
}

TEST(FlatField, FindsTheResponseOfEachPixelWithinItsUncertainty) {
  Camera camera(6);
  const auto darks = darks_of(camera, 32);
  // Two places that differ in their light, as two geometries of the standard do.
  const auto lit = stack_of({camera.read(milliseconds(512), 24, 4000.0), camera.read(milliseconds(512), 8, 3000.0)});
  const auto maps = fit_flat_field(darks, {lit}, kMask);

  ASSERT_TRUE(maps) << describe(maps.error());
  ASSERT_TRUE(maps->flat);
  const double mean = mean_response(camera);
  expect_true_u(
      agreement(maps->flat->layers[0], maps->flat->u[0], camera, [mean](const Pixel& p) { return p.response / mean; }));
  // Shot noise alone: 4000 * 0.512 * 24 + 3000 * 0.512 * 8 DN of 2 e each.
  const double shot = 1.0 / std::sqrt(kElectronsPerDn * 0.512 * (4000.0 * 24 + 3000.0 * 8));
  EXPECT_GT(maps->flat->u[0], shot);
  EXPECT_LT(maps->flat->u[0], 1.15 * shot);
  EXPECT_NEAR(value_of(maps->found, "flat_spread"), 0.02, 0.002);
  EXPECT_LT(value_of(maps->found, "light_uneven"), 0.005);
  EXPECT_EQ(value_of(maps->found, "bad_pixels"), 0.0);
}

TEST(FlatField, CountsPixelsThatSeeLittleOrTooMuch) {
  Camera camera(7);
  camera.at(31, 32).response = 0.1;
  camera.at(25, 25).response = 1.4;
  const auto maps =
      fit_flat_field(darks_of(camera, 16), {stack_of({camera.read(milliseconds(512), 16, 4000.0)})}, kMask);

  ASSERT_TRUE(maps) << describe(maps.error());
  EXPECT_EQ(value_of(maps->found, "bad_pixels"), 2.0);
  EXPECT_EQ(value_of(maps->found, "bad_dead"), 1.0);
  EXPECT_EQ(value_of(maps->found, "bad_uneven"), 2.0);
}

TEST(FlatField, SaysThatItsLightMayBeUneven) {
  Camera camera(8);
  camera.slope = 0.1;
  const auto maps =
      fit_flat_field(darks_of(camera, 16), {stack_of({camera.read(milliseconds(512), 16, 4000.0)})}, kMask);

  ASSERT_TRUE(maps) << describe(maps.error());
  // A quarter of a disc has its centroid 4 R / (3 pi) from the middle.
  const double centroid = 4.0 * kMask.radius_px / (3.0 * 3.141592653589793) / kSide;
  EXPECT_NEAR(value_of(maps->found, "light_uneven"), 0.1 * centroid, 0.004);
}

TEST(FlatField, NeedsLightTwiceInAReadingAndADarkOfItsExposure) {
  Camera camera(9);
  const auto darks = darks_of(camera, 4);

  EXPECT_EQ(fit_flat_field(darks, {}, kMask).error().code, ErrorCode::IncompleteData);
  EXPECT_EQ(fit_flat_field(darks, {stack_of({camera.read(milliseconds(64), 1, 4000.0)})}, kMask).error().code,
            ErrorCode::IncompleteData);
  EXPECT_EQ(fit_flat_field(darks, {stack_of({camera.read(milliseconds(32), 4, 4000.0)})}, kMask).error().code,
            ErrorCode::IncompleteData);
}

// What the maps are for: a mean over pixels of which one in fifty is full at a tenth of the scale is wrong by the light
// that those lose, and right without them. The amount is that of the truth drawn here.
TEST(FlatField, TakesOutOfAMeanWhatBadPixelsPutIntoIt) {
  Camera camera(10);
  std::mt19937_64 chance(11);
  int lost = 0;
  int inside = 0;
  for (std::size_t k = 0; k < camera.pixels().size(); ++k) {
    const bool is_bad = chance() % 50 == 0;
    const int x = static_cast<int>(k % kSide);
    const int y = static_cast<int>(k / kSide);
    if (is_bad) camera.at(x, y).response = 0.1;
    if (is_inside(k)) ++inside;
    if (is_bad && is_inside(k)) ++lost;
  }
  ASSERT_GT(lost, 20);
  const auto maps =
      fit_flat_field(darks_of(camera, 16), {stack_of({camera.read(milliseconds(512), 16, 4000.0)})}, kMask);
  ASSERT_TRUE(maps) << describe(maps.error());
  EXPECT_EQ(value_of(maps->found, "bad_dead"), lost);

  DetectorMaps detector{.width = kSide,
                        .height = kSide,
                        .dark_offset_dn = maps->dark.layers[0],
                        .dark_rate_dn_per_s = maps->dark.layers[1],
                        .flat = maps->flat->layers[0]};
  for (const float value : maps->bad.layers[0]) detector.bad.push_back(value == 0.0F ? 0 : 1);
  const auto bare = FrameReducer::prepare(kSide, kSide, 4095, kMask);
  const auto mapped = FrameReducer::prepare(kSide, kSide, 4095, kMask, std::optional(detector));
  ASSERT_TRUE(bare && mapped);
  const std::vector<std::uint16_t> pixels = camera.expose(milliseconds(512), 2000.0);
  const auto raw = bare->reduce(pixels, 0.512, 0.0);
  const auto reduced = mapped->reduce(pixels, 0.512, 0.0);
  ASSERT_TRUE(raw && reduced && reduced->reduced);

  const double light = 2000.0 * 0.512;
  const double dark = 100.0 + 40.0 * 0.512;
  const double share = static_cast<double>(lost) / inside;
  // Responses of 2 % leave 0.02 / sqrt(1960) in each mean, shot noise as much again: four of both together.
  const double four_u = 4.0 * std::sqrt(0.02 * 0.02 + 1.0 / (light * kElectronsPerDn)) / std::sqrt(1900.0) * light;
  EXPECT_NEAR(raw->raw.mean - dark, light * (1.0 - 0.9 * share), four_u + 0.3) << "darks' own spread";
  EXPECT_NEAR(reduced->reduced->mean_dn, light, four_u);
  EXPECT_GT(0.9 * share * light, 3.0 * four_u) << "the test sees what it is about";
}

}  // namespace
}  // namespace gonio::calibration
