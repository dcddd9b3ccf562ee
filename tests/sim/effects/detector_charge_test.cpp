#include "sim/devices/detector_charge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/optics/detector_response.h"
#include "tests/sim/effects/effects_bench.h"

namespace gonio::sim::test {
namespace {

constexpr double kFullElectrons = 4095.0 * 4.0;

Exposure collected(const Scene& scene, const LightRate& light, double from_s = 0.0, double length_s = 0.02) {
  const Truth truth(scene);
  return DetectorCharge(scene, truth).collect(light, 1.0, from_s, length_s);
}

TEST(DetectorResponse, IsStraightWithoutCoefficients) {
  for (const double x : {0.0, 0.3, 0.9, 1.4}) EXPECT_EQ(response({}, x), x);
}

TEST(DetectorResponse, BendsByItsPolynomial) {
  EXPECT_NEAR(response({.quadratic = -0.02, .cubic = 0.01}, 0.5), 0.5 * (1.0 - 0.01 + 0.0025), 1e-16);
}

TEST(DetectorResponse, LeavesTheKneeSmoothlyAndNeverPassesItsSaturation) {
  const ResponseSpec spec{.knee = 0.8, .saturation = 1.0};

  EXPECT_EQ(response(spec, 0.8), 0.8);
  EXPECT_NEAR((response(spec, 0.8 + 1e-6) - 0.8) / 1e-6, 1.0, 1e-5) << "slope 1 at the knee";
  EXPECT_NEAR(response(spec, 1.0), 0.8 + 0.2 * (1.0 - std::exp(-1.0)), 1e-15);
  EXPECT_LT(response(spec, 1.6), 1.0);
}

TEST(DetectorCharge, BendsTheWholeSignalAndLeavesTheDarkAlone) {
  Scene scene = quiet_scene();
  scene.detector.dark_dn_per_s = 100.0;
  scene.effects.response = ResponseSpec{.quadratic = -0.1};
  const auto curve = [](double electrons) { return electrons * (1.0 - 0.1 * electrons / kFullElectrons); };

  const Exposure exposure = collected(scene, {.target = 8000.0, .ambient = 1000.0});

  // A lit pixel has both lights, another one the veil alone: each on its own place of the curve.
  EXPECT_NEAR(exposure.light_electrons + exposure.dark_electrons, curve(9000.0) + 100.0 * 4.0 * 0.02, 1e-9);
  EXPECT_NEAR(exposure.dark_electrons, curve(1000.0) + 100.0 * 4.0 * 0.02, 1e-9);
}

TEST(DetectorCharge, CollectsForTheExposuresOffsetLonger) {
  Scene scene = quiet_scene();
  scene.detector.dark_dn_per_s = 100.0;
  scene.effects.exposure_offset_s = 5e-4;

  for (const double length_s : {0.001, 0.02, 0.5}) {
    const Exposure exposure = collected(scene, LightRate{.target = 5000.0} * length_s, 0.0, length_s);
    EXPECT_NEAR(exposure.light_electrons, 5000.0 * (length_s + 5e-4), 1e-9);
    EXPECT_NEAR(exposure.dark_electrons, 400.0 * (length_s + 5e-4), 1e-9);
  }
}

TEST(DarkDrift, GrowsByTheHourAndDoublesWithTheTemperature) {
  Scene scene = quiet_scene();
  scene.detector.dark_dn_per_s = 100.0;
  scene.effects.dark_drift =
      DarkDriftSpec{.per_hour = 0.2, .temperature_swing_k = 8.0, .temperature_period_s = 3600.0, .doubling_k = 8.0};
  const double at_s = 900.0;  // a quarter of the swing's period: 8 K above

  const Exposure exposure = collected(scene, {}, at_s - 0.01);

  EXPECT_NEAR(exposure.dark_electrons, 100.0 * 4.0 * 0.02 * (1.0 + 0.2 * 0.25) * 2.0, 1e-9);
  EXPECT_NEAR(in_celsius(DarkDrift(scene).detector_temperature(900.0)), 33.0, 1e-9);
}

TEST(DarkDrift, ShowsOnTheSensorsOfStageAndCamera) {
  Scene scene = quiet_scene();
  scene.effects.dark_drift = DarkDriftSpec{.temperature_swing_k = 4.0, .temperature_period_s = 400.0};
  Bench bench(scene);

  bench.wait(100.0);

  const double shown = static_cast<double>(bench.value(Field::DetectorTemperature)) * bench.map().temperature_scale_c;
  EXPECT_NEAR(shown, 29.0, bench.map().temperature_scale_c);
  EXPECT_NEAR(in_celsius(bench.camera.temperature(bench.now)), 29.0, 1e-9);
}

TEST(DarkDrift, MovesTheOffsetOfAFrame) {
  Scene scene = quiet_scene();
  scene.effects.dark_drift = DarkDriftSpec{.offset_dn_per_hour = 2.0};

  EXPECT_NEAR(collected(scene, {}, 1800.0 - 0.01).offset_shift_dn, 1.0, 1e-12);

  Exposure dark{.number = 1};
  dark.offset_shift_dn = 3.0;
  EXPECT_NEAR(draw_region(scene.detector, dark, 7).mean, 67.0, 1e-9);
  EXPECT_EQ(render_frame(scene.detector, dark, 7)[0], 67);
}

TEST(DarkDrift, WandersByItsDeviationAndItsCorrelation) {
  constexpr int kSeeds = 2000;
  Scene scene = quiet_scene();
  scene.effects.dark_drift = DarkDriftSpec{.wander = 0.05, .offset_wander_dn = 2.0, .correlation_s = 600.0};
  double rate2 = 0.0, offset2 = 0.0, product = 0.0, both = 0.0;
  for (int k = 0; k < kSeeds; ++k) {
    scene.seed = static_cast<std::uint64_t>(1000 + k);
    const DarkDrift drift(scene);
    const double rate = drift.rate_factor(5000.0) - 1.0;
    const double offset = drift.offset_shift_dn(5000.0);
    rate2 += rate * rate;
    offset2 += offset * offset;
    product += offset * drift.offset_shift_dn(5600.0);
    both += rate * offset;
  }

  // Five standard errors of 2000 seeds: of a variance sqrt(2/n), of a correlation 1/sqrt(n).
  EXPECT_NEAR(rate2 / kSeeds / (0.05 * 0.05), 1.0, 5.0 * std::sqrt(2.0 / kSeeds));
  EXPECT_NEAR(offset2 / kSeeds / 4.0, 1.0, 5.0 * std::sqrt(2.0 / kSeeds));
  EXPECT_NEAR(product / offset2, std::exp(-0.5), 5.0 / std::sqrt(kSeeds)) << "one correlation time apart";
  EXPECT_NEAR(both / std::sqrt(rate2 * offset2), 0.0, 5.0 / std::sqrt(kSeeds)) << "each its own stream";
}

}  // namespace
}  // namespace gonio::sim::test
