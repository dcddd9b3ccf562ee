// Encoder errors and backlash: what the encoders do not see.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effects_bench.h"

namespace gonio::sim::test {
namespace {

using stage::index_of;

TEST(EncoderError, IsASineOfTheEncoderOnItsOwnAxis) {
  Scene scene = quiet_scene();
  scene.effects.encoder[index_of(Axis::ThetaI)] =
      PeriodicError{.amplitude = degrees(0.05), .period = degrees(90.0), .phase = degrees(30.0)};
  const Truth truth(scene);
  const LightPath path(scene, truth);

  for (const double deg : {0.0, 10.0, 52.5}) {
    const Geometry g = path.true_geometry(pose_at(at_deg(deg, 20.0, 90.0)));
    EXPECT_NEAR(in_degrees(g.theta_i), deg + 0.05 * std::sin(in_rad(4.0 * deg + 30.0)), 1e-12);
    EXPECT_EQ(g.theta_r, degrees(20.0));
    EXPECT_EQ(g.phi_r, degrees(90.0));
  }
}

TEST(EncoderError, ChangesAReadingByTheCosineOfTheTrueAngle) {
  Scene scene = quiet_scene();
  scene.effects.encoder[index_of(Axis::ThetaI)] = PeriodicError{.amplitude = degrees(0.1)};
  const double true_deg = 60.0 + 0.1 * std::sin(in_rad(60.0));

  const double factor = target_rate(scene, at_deg(60, 0, 0)) / target_rate(quiet_scene(), at_deg(60, 0, 0));

  EXPECT_NEAR(factor, std::cos(in_rad(true_deg)) / std::cos(in_rad(60.0)), 1e-12);
}

Scene with_play(double play_deg) {
  Scene scene = quiet_scene();
  scene.stage.axes[index_of(Axis::ThetaI)].backlash = play_deg;
  return scene;
}

/// Where theta_i truly points, after moves to these targets.
double true_theta_i(Bench& bench, std::initializer_list<double> targets) {
  for (const double target : targets) {
    bench.move(Axis::ThetaI, target);
    bench.wait(20.0);
  }
  bench.instrument.advance_to(bench.now);
  const Scene& scene = bench.instrument.scene();
  return in_degrees(LightPath(scene, bench.instrument.truth()).true_geometry(bench.instrument.pose(bench.now)).theta_i);
}

TEST(Backlash, LeavesTheArmBehindTheEncoderByHalfOfThePlay) {
  Bench bench(with_play(0.2));
  bench.home();

  const double from_below = true_theta_i(bench, {30.0});
  const double from_above = true_theta_i(bench, {50.0, 30.0});

  EXPECT_NEAR(from_below, 29.9, 1e-9);
  EXPECT_NEAR(from_above, 30.1, 1e-9);
  EXPECT_NEAR(bench.position(Axis::ThetaI), 30.0, 1e-4) << "the encoder sits on the motor";
}

TEST(Backlash, IsNotTakenUpByAMoveShorterThanThePlay) {
  Bench bench(with_play(0.2));
  bench.home();

  EXPECT_NEAR(true_theta_i(bench, {30.0}), 29.9, 1e-9);
  EXPECT_NEAR(true_theta_i(bench, {29.85}), 29.9, 1e-9) << "the arm stands still";
  EXPECT_NEAR(true_theta_i(bench, {29.75}), 29.85, 1e-9) << "0.2 back is the play, 0.05 more it moves";
  EXPECT_NEAR(true_theta_i(bench, {29.85}), 29.85, 1e-9);
}

TEST(Backlash, GivesTheSamePlaceFromTheSameSide) {
  Bench bench(with_play(0.2));
  bench.home();

  const double first = true_theta_i(bench, {20.0, 30.0});
  const double again = true_theta_i(bench, {60.0, 29.0, 30.0});

  EXPECT_NEAR(first, again, 1e-9);
}

TEST(Backlash, IsKeptWithoutPower) {
  Bench bench(with_play(0.2));
  bench.home();
  ASSERT_NEAR(true_theta_i(bench, {50.0, 30.0}), 30.1, 1e-9);

  Bench next(with_play(0.2), bench.instrument.memory(bench.now));

  const Scene& scene = next.instrument.scene();
  const StagePose pose = next.instrument.pose(next.now);
  EXPECT_NEAR(in_degrees(LightPath(scene, next.instrument.truth()).true_geometry(pose).theta_i), 30.1, 1e-9);
}

TEST(Backlash, StandsWhereABrakeLeavesIt) {
  Bench bench(with_play(0.2));
  bench.home();
  bench.move(Axis::ThetaI, 60.0);
  bench.wait(1.0);
  bench.halt(1);
  bench.wait(5.0);
  bench.instrument.advance_to(bench.now);

  const StagePose pose = bench.instrument.pose(bench.now);

  EXPECT_NEAR(pose.lags[index_of(Axis::ThetaI)], -0.1, 1e-12);
  EXPECT_EQ(pose.lags[index_of(Axis::ThetaR)], 0.0);
}

}  // namespace
}  // namespace gonio::sim::test
