#include "sim/devices/detector_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/devices/reading_level.h"
#include "tests/sim/bench.h"

namespace gonio::sim::test {
namespace {

// The statistics of a frame's aperture, computed here from its definition: centres within the radius.
RegionStatistics measured(const DetectorSpec& spec, const std::vector<std::uint16_t>& frame) {
  const Aperture a = aperture_of(spec);
  std::vector<double> inside;
  for (int y = 0; y < spec.height_px; ++y) {
    for (int x = 0; x < spec.width_px; ++x) {
      const double dx = x - a.centre_x_px;
      const double dy = y - a.centre_y_px;
      if (dx * dx + dy * dy > a.radius_px * a.radius_px) continue;
      inside.push_back(frame[static_cast<std::size_t>(y * spec.width_px + x)]);
    }
  }
  RegionStatistics s{.n = static_cast<std::uint32_t>(inside.size())};
  for (const double v : inside) s.mean += v / s.n;
  for (const double v : inside) {
    s.m2 += std::pow(v - s.mean, 2) / s.n;
    s.m3 += std::pow(v - s.mean, 3) / s.n;
    s.m4 += std::pow(v - s.mean, 4) / s.n;
    s.saturated += v >= 4095.0 ? 1U : 0U;
  }
  return s;
}

/// Mean and variance over many exposures of one number.
struct Spread {
  double sum = 0.0;
  double sum2 = 0.0;
  int n = 0;
  void add(double v) {
    sum += v;
    sum2 += v * v;
    ++n;
  }
  [[nodiscard]] double mean() const { return sum / n; }
  [[nodiscard]] double variance() const { return sum2 / n - mean() * mean(); }
  [[nodiscard]] double error_of_mean() const { return std::sqrt(variance() / n); }
};

DetectorSpec noisy_detector() {
  DetectorSpec spec = quiet_scene().detector;
  spec.read_noise_dn = 1.5;
  return spec;
}

TEST(DetectorNoise, FollowsThePhotonTransferCurve) {
  // EMVA 1288 (2021) eq 15: variance = K (mean - dark mean) + dark variance, with K in DN per electron and 1/12 for
  // rounding.
  const DetectorSpec spec = noisy_detector();
  constexpr std::uint64_t kSeed = 20260101;
  SCOPED_TRACE(kSeed);
  for (const double electrons : {200.0, 1000.0, 4000.0, 9000.0}) {
    Spread variance;
    Spread mean;
    for (std::uint64_t number = 1; number <= 40; ++number) {
      const Exposure exposure{.number = number, .light_electrons = electrons};
      const RegionStatistics s = measured(spec, render_frame(spec, exposure, kSeed));
      mean.add(s.mean);
      variance.add(s.m2 * s.n / (s.n - 1.0));
    }
    const double expected = electrons / 16.0 + 1.5 * 1.5 + 1.0 / 12.0;
    EXPECT_NEAR(mean.mean(), 64.0 + electrons / 4.0, 5.0 * mean.error_of_mean()) << electrons;
    EXPECT_NEAR(variance.mean(), expected, 5.0 * variance.error_of_mean()) << electrons;
  }
}

TEST(DetectorNoise, GivesTheSameFrameForTheSameExposureAndAnotherForTheNext) {
  const DetectorSpec spec = noisy_detector();
  const Exposure first{.number = 1, .light_electrons = 1000.0};
  const Exposure next{.number = 2, .light_electrons = 1000.0};

  EXPECT_EQ(render_frame(spec, first, 7), render_frame(spec, first, 7));
  EXPECT_NE(render_frame(spec, first, 7), render_frame(spec, next, 7));
  EXPECT_NE(render_frame(spec, first, 7), render_frame(spec, first, 8));
}

TEST(DetectorNoise, ClipsAtFullScaleAndCountsWhatIsClipped) {
  const DetectorSpec spec = noisy_detector();
  const Exposure exposure{.number = 1, .light_electrons = 40000.0};

  const RegionStatistics drawn = draw_region(spec, exposure, 7);

  EXPECT_EQ(drawn.mean, 4095.0);
  EXPECT_EQ(drawn.saturated, drawn.n);
  EXPECT_EQ(measured(spec, render_frame(spec, exposure, 7)).saturated, drawn.n);
}

TEST(DetectorNoise, LightsADiscInTheMiddleOnly) {
  DetectorSpec spec = quiet_scene().detector;
  const auto frame = render_frame(spec, {.number = 1, .light_electrons = 4000.0}, 7);

  EXPECT_GT(frame[32 * 64 + 32], 900);
  EXPECT_EQ(frame[0], 64);
}

TEST(DetectorNoise, MultipliesSignalAndNoiseByTheGain) {
  const DetectorSpec spec = noisy_detector();
  const Exposure exposure{.number = 1, .light_electrons = 1000.0, .gain_db = 6.0};
  const double gain = std::pow(10.0, 0.3);

  const RegionStatistics s = draw_region(spec, exposure, 7);

  EXPECT_NEAR(s.mean, 64.0 + 250.0 * gain, 3.0);
  EXPECT_NEAR(s.m2 / (gain * gain * (1000.0 / 16.0 + 2.25)), 1.0, 0.3);
}

class FrameAgainstRegion : public testing::TestWithParam<double> {};

TEST_P(FrameAgainstRegion, HaveTheSameDistributionOfTheirMoments) {
  const DetectorSpec spec = noisy_detector();
  constexpr std::uint64_t kSeed = 4711;
  constexpr std::uint64_t kFrames = 150;
  SCOPED_TRACE(kSeed);
  Spread frame_mean, frame_m2, frame_m3, frame_m4, drawn_mean, drawn_m2, drawn_m3, drawn_m4;
  for (std::uint64_t number = 1; number <= kFrames; ++number) {
    const Exposure exposure{.number = number, .light_electrons = GetParam(), .dark_electrons = 3.0};
    const RegionStatistics f = measured(spec, render_frame(spec, exposure, kSeed));
    const RegionStatistics d = draw_region(spec, exposure, kSeed + 1);
    ASSERT_EQ(f.n, d.n);
    frame_mean.add(f.mean), frame_m2.add(f.m2), frame_m3.add(f.m3), frame_m4.add(f.m4);
    drawn_mean.add(d.mean), drawn_m2.add(d.m2), drawn_m3.add(d.m3), drawn_m4.add(d.m4);
  }
  const auto expect_same = [](const Spread& a, const Spread& b, const char* what) {
    EXPECT_NEAR(a.mean(), b.mean(), 5.0 * std::hypot(a.error_of_mean(), b.error_of_mean())) << what;
    // Variances of 150 values each scatter by sqrt(2/150) = 12 %, of skewed moments by more.
    EXPECT_NEAR(a.variance() / b.variance(), 1.0, 0.6) << what;
  };
  expect_same(frame_mean, drawn_mean, "mean");
  expect_same(frame_m2, drawn_m2, "m2");
  expect_same(frame_m3, drawn_m3, "m3");
  expect_same(frame_m4, drawn_m4, "m4");
}

INSTANTIATE_TEST_SUITE_P(Electrons, FrameAgainstRegion, testing::Values(0.0, 100.0, 2000.0, 9000.0, 16100.0));

TEST(ReadingLevel, GivesWhatTheStageAndTheCameraGive) {
  Scene scene = quiet_scene();
  scene.detector.read_noise_dn = 1.5;
  Bench bench(scene);
  bench.home();
  bench.open_shutters();
  bench.move(Axis::ThetaI, 45.0);
  bench.wait(20.0);
  bench.move(Axis::ThetaR, 30.0);
  bench.wait(20.0);
  const Exposure exposure = bench.expose(0.02);
  const ReadingLevel level(scene);

  const ReadingAnswer answer = level.read({.target = Station::Sample,
                                           .encoders = {degrees(45.0), degrees(0.0), degrees(30.0), degrees(0.0)},
                                           .wavelength = nanometres(568.0),
                                           .exposure = seconds(0.02),
                                           .at_scene_s = 100.0,
                                           .move = 3,
                                           .exposure_number = exposure.number});

  const RegionStatistics same = draw_region(scene.detector, exposure, scene.seed);
  EXPECT_NEAR(answer.region.mean, same.mean, 1e-9);
  EXPECT_NEAR(answer.region.m2, same.m2, 1e-9);
  EXPECT_NEAR(answer.monitor.mean, 1.0, 1e-12);
}

TEST(ReadingLevel, SeesOnlyDarkWithItsDetectorShutterClosed) {
  Scene scene = quiet_scene();
  scene.detector.dark_dn_per_s = 100.0;
  const ReadingLevel level(scene);

  const ReadingAnswer answer =
      level.read({.is_dark = true, .wavelength = nanometres(568.0), .exposure = seconds(0.5), .exposure_number = 1});

  EXPECT_NEAR(answer.region.mean, 64.0 + 50.0, 1.0);
}

}  // namespace
}  // namespace gonio::sim::test
