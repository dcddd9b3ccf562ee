#include "sim/optics/speckle_pattern.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/devices/reading_level.h"
#include "tests/sim/effects/effects_bench.h"

namespace gonio::sim::test {
namespace {

TEST(SpecklePattern, HasMeanOneItsContrastAndItsCorrelation) {
  constexpr int kSide = 96;
  constexpr int kPlaces = 200;
  constexpr std::uint64_t kSeed = 31;
  SCOPED_TRACE(kSeed);
  const SpeckleSpec spec{.contrast = 0.3, .grain_px = 3};
  double sum = 0.0, sum2 = 0.0, near = 0.0, far = 0.0;
  double n = 0.0;
  for (std::uint64_t place = 1; place <= kPlaces; ++place) {
    const SpecklePattern pattern(spec, kSide, kSide, kSeed, place);
    for (int y = 0; y < kSide - 4; ++y) {
      for (int x = 0; x < kSide - 4; ++x) {
        const double d = pattern(x, y) - 1.0;
        sum += d;
        sum2 += d * d;
        near += d * (pattern(x + 1, y + 1) - 1.0);
        far += d * (pattern(x + 3, y) - 1.0);
        n += 1.0;
      }
    }
  }
  const double grains = n / 9.0;

  // Five standard errors; the variance of a variance is (2 + excess) sigma^4, excess 6 contrast^2 of a gamma.
  EXPECT_NEAR(sum / n, 0.0, 5.0 * 0.3 / std::sqrt(grains));
  EXPECT_NEAR(sum2 / n, 0.09, 5.0 * 0.09 * std::sqrt((2.0 + 0.54) / grains));
  EXPECT_NEAR(near / sum2, 4.0 / 9.0, 5.0 / std::sqrt(grains)) << "(1 - 1/3)(1 - 1/3)";
  EXPECT_NEAR(far / sum2, 0.0, 5.0 / std::sqrt(grains)) << "a grain away";
}

TEST(SpecklePattern, IsAlwaysTheSameAtAPlaceAndAnotherAtTheNext) {
  const SpeckleSpec spec{.contrast = 0.5, .grain_px = 1};
  const SpecklePattern here(spec, 64, 64, 5, 1), again(spec, 64, 64, 5, 1), there(spec, 64, 64, 5, 2);

  EXPECT_EQ(here(10, 20), again(10, 20));
  EXPECT_NE(here(10, 20), there(10, 20));
}

Scene grainy() {
  Scene scene = quiet_scene();
  scene.detector.read_noise_dn = 1.5;
  scene.detector.speckle = SpeckleSpec{.contrast = 0.1, .grain_px = 4};
  return scene;
}

double mean_of(const ReadingLevel& level, double theta_r, int frames, std::uint64_t first = 1) {
  double sum = 0.0;
  for (int k = 0; k < frames; ++k) {
    sum += level
               .read({.encoders = at_deg(0, theta_r, 0),
                      .wavelength = nanometres(568.0),
                      .exposure = seconds(0.02),
                      .exposure_number = first + static_cast<std::uint64_t>(k)})
               .region.mean;
  }
  return sum / frames;
}

TEST(Speckle, IsNotAveragedAwayByRepeats) {
  // Grains of 4 x 4 in a disc of radius 12: some 28 of them, so the aperture's mean stands 0.1 / sqrt(28) = 1.9 % off,
  // a different way at each place; the noise of a reading of 64 frames is 100 times smaller.
  const ReadingLevel level(grainy());
  const double expected = 64.0 + kWhite * 0.5 * 0.02 / 4.0;
  double deviation2 = 0.0;
  for (int k = 0; k < 40; ++k) {
    const double first = mean_of(level, k, 16);
    const double next = mean_of(level, k, 16, 1000);
    EXPECT_NEAR(first / next, 1.0, 2e-3) << "repeats agree";
    deviation2 += std::pow(first / expected - 1.0, 2) / 40.0;
  }

  EXPECT_NEAR(std::sqrt(deviation2), 0.019, 0.008) << "and are wrong together";
}

TEST(Speckle, BelongsToTheDirectionsWithinItsCell) {
  const Scene scene = grainy();
  const Truth truth(scene);
  const LightPath path(scene, truth);
  const auto place = [&](double theta_r, double carriage = 0.0) {
    return path.place(pose_at(at_deg(30, theta_r, 0), carriage));
  };

  EXPECT_EQ(place(45.0), place(45.04));
  EXPECT_NE(place(45.0), place(45.2));
  EXPECT_NE(place(45.0), place(45.0, kReferenceMm));
}

TEST(Speckle, IsTheSameInAFrameAndInItsStatistics) {
  const Scene scene = grainy();
  const Exposure exposure{.number = 3, .light_electrons = 8000.0, .place = 77};
  const auto frame = render_frame(scene.detector, exposure, 9);
  const Aperture a = aperture_of(scene.detector);
  double sum = 0.0, n = 0.0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      if (std::hypot(x - a.centre_x_px, y - a.centre_y_px) > a.radius_px) continue;
      sum += frame[static_cast<std::size_t>(y * 64 + x)];
      n += 1.0;
    }
  }

  const RegionStatistics drawn = draw_region(scene.detector, exposure, 9);

  // Another noise, the same pattern: shot noise of 22 DN over 448 pixels leaves 1.1 DN; the pattern shifts by 40.
  EXPECT_NEAR(drawn.mean, sum / n, 5.0 * std::sqrt(2.0) * 1.1);
  EXPECT_GT(drawn.m2, 100.0 * 100.0) << "texture: a tenth of 2000 DN, and the noise";
}

}  // namespace
}  // namespace gonio::sim::test
