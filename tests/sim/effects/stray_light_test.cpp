#include <gtest/gtest.h>

#include <cmath>

#include "sim/devices/reading_level.h"
#include "sim/optics/reflected_share.h"
#include "tests/sim/effects/effects_bench.h"

namespace gonio::sim::test {
namespace {

Scene straying(const StraySpec& stray) {
  Scene scene = quiet_scene();
  scene.filters[0].transmission = 0.8;
  scene.effects.stray = stray;
  return scene;
}

const Geometry kPlace = at_deg(60, 30, 90);

TEST(StrayLight, OfTheRoomFallsWhateverTheSourceShutterAndTheTargetDo) {
  const Scene scene = straying({.ambient_electrons_per_s = 500.0});
  for (const double carriage : {0.0, kReferenceMm, kTrapMm, kBetweenMm}) {
    for (const bool source_open : {false, true}) {
      StagePose pose = pose_at(kPlace, carriage);
      pose.source_open = source_open;
      EXPECT_EQ(rate_of(scene, pose).ambient, 500.0);
      EXPECT_EQ(rate_of(scene, pose).veil, 0.0);
    }
  }
}

TEST(StrayLight, OfAnyKindStopsAtTheDetectorsShutter) {
  const Scene scene = straying({.ambient_electrons_per_s = 500.0, .source_share = 0.01, .internal_share = 0.01});
  StagePose pose = pose_at(kPlace);
  pose.detector_open = false;

  const LightRate rate = rate_of(scene, pose);

  EXPECT_EQ(rate.ambient + rate.veil + rate.target, 0.0);
}

TEST(StrayLight, OfTheSourceIsSeenBeforeTheTrapToo) {
  const Scene scene = straying({.source_share = 0.002});

  for (const double carriage : {0.0, kReferenceMm, kTrapMm})
    EXPECT_DOUBLE_EQ(rate_of(scene, pose_at(kPlace, carriage)).veil, kWhite * 0.8 * 0.002);
  StagePose closed = pose_at(kPlace, kTrapMm);
  closed.source_open = false;
  EXPECT_EQ(rate_of(scene, closed).veil, 0.0);
}

TEST(StrayLight, OfTheDetectorsInsideGoesAsAllTheLightThatLeavesTheTarget) {
  const Scene scene = straying({.internal_share = 0.01});

  // A Lambertian of 0.5 returns half of what falls on it; what falls on it goes as the cosine.
  EXPECT_NEAR(rate_of(scene, pose_at(kPlace)).veil, kWhite * 0.8 * 0.01 * 0.5 * 0.5, 1e-6);
  EXPECT_EQ(rate_of(scene, pose_at(kPlace, kTrapMm)).veil, 0.0);
  // The reference at 8 deg returns its certificate.
  EXPECT_NEAR(rate_of(scene, pose_at(at_deg(8, 30, 90), kReferenceMm)).veil,
              kWhite * 0.8 * 0.01 * 0.99 * std::cos(in_rad(8.0)), 0.01);
}

TEST(ReflectedShare, IsTheIntegralOfTheSample) {
  // RPV wheat, 40 digit reference values (tanh-sinh about the retro direction).
  const Scene scene = scene_with(wheat());
  const Truth truth(scene);
  const ReflectedShare share(scene, truth);

  EXPECT_NEAR(share.sample(degrees(30.0)), 0.734215727909711, 1e-5);
  EXPECT_NEAR(share.sample(degrees(60.0)), 0.712386680567085, 1e-5);
  EXPECT_NEAR(share.sample(degrees(85.0)), 0.747348019118055, 1e-4);
}

TEST(StrayLight, OfTheRoomIsNotLampLight) {
  // Twice the lamp: the target's light and the source's stray light double, the room's stays.
  Scene scene = straying({.ambient_electrons_per_s = 5000.0, .source_share = 0.01});
  scene.filters[0].transmission = 1.0;
  const auto electrons = [&](double power) {
    scene.lamp.power = power;
    Bench bench(scene);
    bench.home();
    bench.open_shutters();
    bench.wait(1.0);
    return bench.expose(0.1);
  };
  const Exposure once = electrons(1.0);
  const Exposure twice = electrons(2.0);

  EXPECT_NEAR(once.light_electrons, kWhite * 0.5 * 0.1, 1e-6);
  EXPECT_NEAR(once.dark_electrons, 500.0 + kWhite * 0.01 * 0.1, 1e-6);
  EXPECT_NEAR(twice.light_electrons, 2.0 * once.light_electrons, 1e-6);
  EXPECT_NEAR(twice.dark_electrons, 500.0 + 2.0 * kWhite * 0.01 * 0.1, 1e-6);
}

TEST(StrayLight, OfTheRoomIsReadAloneWithTheSourceShutterClosed) {
  const Scene scene = straying({.ambient_electrons_per_s = 50000.0, .source_share = 0.01, .internal_share = 0.01});
  const ReadingLevel level(scene);
  const auto mean = [&](bool is_dark, bool is_ambient) {
    return level
        .read({.is_dark = is_dark,
               .is_ambient = is_ambient,
               .encoders = kPlace,
               .wavelength = nanometres(568.0),
               .exposure = seconds(0.1)})
        .region.mean;
  };

  // 5000 electrons in 448 pixels of 4 electrons a DN: the mean's noise is 0.84 DN.
  EXPECT_NEAR(mean(false, true), 64.0 + 1250.0, 5.0 * 0.84);
  EXPECT_NEAR(mean(true, false), 64.0, 1e-9);
}

TEST(StrayLight, OfTheRoomCountsForTheTimeThatTheDetectorsShutterIsOpen) {
  Scene scene = straying({.ambient_electrons_per_s = 5000.0});
  scene.stage.shutter_s = 0.1;
  Bench bench(scene);
  bench.wait(1.0);

  bench.write(Field::DetectorShutterCommand, 1);  // open 0.1 s from now; the source stays shut
  const Exposure exposure = bench.expose(0.4);

  EXPECT_NEAR(exposure.dark_electrons, 5000.0 * 0.3, 1e-6);
}

}  // namespace
}  // namespace gonio::sim::test
