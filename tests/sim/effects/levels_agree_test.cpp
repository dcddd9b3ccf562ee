// Stage, camera and frames on one side, ReadingLevel on the other: the same effects, the same distribution.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/devices/reading_level.h"
#include "tests/sim/effects/effects_bench.h"

namespace gonio::sim::test {
namespace {

Scene everything() {
  Scene scene = scene_with(wheat());
  scene.sample.push_back({.surface = sea(), .weight = 0.5});
  scene.detector.read_noise_dn = 1.5;
  scene.detector.dark_dn_per_s = 100.0;
  scene.detector.speckle = SpeckleSpec{.contrast = 0.05, .grain_px = 3};
  scene.lamp.flicker = 0.01;
  scene.lamp.drift_per_hour = -0.2;
  EffectsSpec& effects = scene.effects;
  effects.cones = ConeSpec{.source_half = degrees(1.0), .detector_half = degrees(1.5)};
  effects.overlap = OverlapSpec{.spot_radius = millimetres(8.0), .field_radius = millimetres(6.0)};
  effects.mounting =
      MountingSpec{.sample = {.lean_0 = degrees(0.5), .lean_90 = degrees(-0.3), .height = millimetres(0.5)}};
  effects.encoder[stage::index_of(Axis::ThetaR)] = PeriodicError{.amplitude = degrees(0.1), .phase = degrees(40.0)};
  effects.polarisation = PolarisationSpec{.source_degree = 0.4, .detector_diattenuation = 0.2};
  effects.stray = StraySpec{.ambient_electrons_per_s = 2000.0, .source_share = 0.002, .internal_share = 0.005};
  effects.response = ResponseSpec{.quadratic = -0.03, .cubic = 0.01, .knee = 0.9, .saturation = 1.05};
  effects.dark_drift = DarkDriftSpec{.per_hour = 0.5, .wander = 0.1, .offset_wander_dn = 1.0, .correlation_s = 100.0};
  effects.exposure_offset_s = 2e-4;
  for (const Axis axis : {Axis::ThetaI, Axis::ThetaR}) scene.stage.axes[stage::index_of(axis)].backlash = 0.1;
  return scene;
}

RegionStatistics of_frame(const Scene& scene, const Exposure& exposure) {
  const auto frame = render_frame(scene.detector, exposure, scene.seed);
  const Aperture a = aperture_of(scene.detector);
  RegionStatistics s;
  std::vector<double> values;
  for (int y = 0; y < scene.detector.height_px; ++y) {
    for (int x = 0; x < scene.detector.width_px; ++x) {
      if (std::hypot(x - a.centre_x_px, y - a.centre_y_px) <= a.radius_px)
        values.push_back(frame[static_cast<std::size_t>(y * scene.detector.width_px + x)]);
    }
  }
  s.n = static_cast<std::uint32_t>(values.size());
  for (const double v : values) s.mean += v / s.n;
  for (const double v : values) s.m2 += (v - s.mean) * (v - s.mean) / s.n;
  return s;
}

TEST(FramesAndReadings, FeelTheSameEffectsInMeanAndVariance) {
  const Scene scene = everything();
  SCOPED_TRACE(scene.seed);
  Bench bench(scene);
  bench.home();
  bench.open_shutters();
  bench.move(Axis::ThetaI, 40.0);
  bench.wait(20.0);
  bench.move(Axis::ThetaR, 55.0);
  bench.wait(20.0);
  bench.move(Axis::PhiR, 180.0);
  bench.wait(20.0);
  const ReadingLevel level(scene);
  constexpr int kFrames = 60;
  double frame_sum = 0.0, level_sum = 0.0, frame_m2 = 0.0, level_m2 = 0.0, difference2 = 0.0;

  for (int k = 0; k < kFrames; ++k) {
    const double at_s = in_seconds(bench.now - kPowerUp);
    const Exposure exposure = bench.expose(0.02);
    const RegionStatistics frame = of_frame(scene, exposure);
    const ReadingAnswer reading = level.read({.encoders = at_deg(40, 55, 180),
                                              .wavelength = nanometres(568.0),
                                              .exposure = seconds(0.02),
                                              .at_scene_s = at_s,
                                              .move = 4,
                                              .exposure_number = exposure.number});
    // The light is the same to rounding: with the noise of the frame's own number, so are the statistics.
    EXPECT_NEAR(draw_region(scene.detector, exposure, scene.seed).mean, reading.region.mean, 1e-6);
    frame_sum += frame.mean / kFrames;
    level_sum += reading.region.mean / kFrames;
    frame_m2 += frame.m2 / kFrames;
    level_m2 += reading.region.m2 / kFrames;
    difference2 += std::pow(frame.mean - reading.region.mean, 2) / kFrames;
    bench.wait(3.0);
  }

  // Frame and reading differ by the noise of two of them alone (EMVA 1288: gain x mean, read noise, rounding), for
  // flicker and speckle are the same; 5 standard errors allowed.
  EXPECT_NEAR(frame_sum, level_sum, 5.0 * std::sqrt(difference2 / kFrames));
  const double noise = 2.0 * ((level_sum - 64.0) / 4.0 + 1.5 * 1.5 + 1.0 / 12.0) / 448.0;
  EXPECT_NEAR(difference2 / noise, 1.0, 5.0 * std::sqrt(2.0 / kFrames));
  EXPECT_NEAR(frame_m2 / level_m2, 1.0, 5.0 * std::sqrt(2.0 * 2.0 / (448.0 * kFrames)));
}

TEST(FramesAndReadings, FeelEachEffectAlone) {
  const auto mean = [](const Scene& scene) {
    return ReadingLevel(scene)
        .read({.encoders = at_deg(40, 55, 180),
               .wavelength = nanometres(568.0),
               .exposure = seconds(0.02),
               .at_scene_s = 1800.0})
        .region.mean;
  };
  const Scene all = everything();
  Scene plain = all;
  plain.effects = {};
  plain.detector.speckle = {};
  for (AxisSpec& axis : plain.stage.axes) axis.backlash = 0.0;
  std::vector<Scene> alone(10, plain);
  alone[0].effects.cones = all.effects.cones;
  alone[1].effects.overlap = all.effects.overlap;
  alone[2].effects.mounting = all.effects.mounting;
  alone[3].effects.encoder = all.effects.encoder;
  alone[4].effects.polarisation = all.effects.polarisation;
  alone[5].effects.stray = all.effects.stray;
  alone[6].effects.response = all.effects.response;
  alone[7].effects.dark_drift = all.effects.dark_drift;
  alone[8].effects.exposure_offset_s = all.effects.exposure_offset_s;
  alone[9].stage.axes = all.stage.axes;

  // The noise is the exposure's own and stays: what differs is the effect.
  for (std::size_t k = 0; k < alone.size(); ++k) EXPECT_GT(std::abs(mean(alone[k]) - mean(plain)), 0.05) << k;
}

}  // namespace
}  // namespace gonio::sim::test
