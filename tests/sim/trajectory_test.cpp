#include "sim/devices/trajectory.h"

#include <gtest/gtest.h>

#include <array>

namespace gonio::sim {
namespace {

constexpr Instant kStart{std::chrono::seconds(5)};
constexpr double kNear = 1e-7;  // the clock's nanosecond at 20 units a second

Instant after(double s) {
  return kStart + seconds(s);
}

TEST(Trajectory, RampsUpRunsAndRampsDownAsTheTextbookSays) {
  // 100 units at 20 a second with 40 a second squared: ramps of 0.5 s over 5 units each, 4.5 s between them.
  const auto path = Trajectory::move(10.0, 110.0, {.speed = 20.0, .acceleration = 40.0}, kStart);

  EXPECT_NEAR(in_seconds(path.end() - kStart), 5.5, 1e-9);
  EXPECT_NEAR(path.position(after(0.25)), 10.0 + 0.5 * 40.0 * 0.25 * 0.25, kNear);
  EXPECT_NEAR(path.position(after(0.5)), 15.0, kNear);
  EXPECT_NEAR(path.position(after(2.75)), 60.0, kNear);
  EXPECT_NEAR(path.velocity(after(2.75)), 20.0, kNear);
  EXPECT_NEAR(path.position(after(5.0)), 105.0, kNear);
  EXPECT_NEAR(path.velocity(after(5.25)), 10.0, 1e-6);
  EXPECT_EQ(path.position(after(5.6)), 110.0);
}

TEST(Trajectory, NeverReachesTopSpeedOnAShortWay) {
  // 1.6 units: up to half way in sqrt(1.6 / 40) = 0.2 s, at 8 a second.
  const auto path = Trajectory::move(0.0, -1.6, {.speed = 20.0, .acceleration = 40.0}, kStart);

  EXPECT_NEAR(in_seconds(path.end() - kStart), 0.4, 1e-9);
  EXPECT_NEAR(path.position(after(0.2)), -0.8, kNear);
  EXPECT_NEAR(path.velocity(after(0.2)), -8.0, 1e-6);
}

TEST(Trajectory, StandsBeforeItsStartAndAfterItsEnd) {
  const auto path = Trajectory::move(3.0, 4.0, {.speed = 20.0, .acceleration = 40.0}, kStart);

  EXPECT_EQ(path.position(kStart - seconds(1.0)), 3.0);
  EXPECT_FALSE(path.is_moving(kStart - seconds(1.0)));
  EXPECT_TRUE(path.is_moving(kStart));
  EXPECT_FALSE(path.is_moving(path.end()));
}

TEST(Trajectory, DoesNothingOnAWayOfNoLength) {
  const auto path = Trajectory::move(3.0, 3.0, {.speed = 20.0, .acceleration = 40.0}, kStart);

  EXPECT_FALSE(path.is_moving(kStart));
  EXPECT_EQ(path.position(after(1.0)), 3.0);
}

TEST(Trajectory, BrakesOverVSquaredByTwoA) {
  for (const double velocity : {20.0, -20.0}) {
    const auto path = Trajectory::brake(50.0, velocity, 40.0, kStart);

    EXPECT_NEAR(in_seconds(path.end() - kStart), 0.5, 1e-9);
    EXPECT_NEAR(path.position(after(1.0)) - 50.0, velocity / 4.0, kNear) << velocity;
    EXPECT_NEAR(path.position(after(0.25)) - 50.0, velocity * (0.25 - 0.0625), kNear) << velocity;
    EXPECT_NEAR(path.velocity(kStart), velocity, kNear);
  }
}

TEST(Trajectory, MovesWithTheVelocityThatItClaims) {
  const std::array paths{Trajectory::move(0.0, 47.0, {.speed = 20.0, .acceleration = 40.0}, kStart),
                         Trajectory::move(5.0, 4.0, {.speed = 20.0, .acceleration = 40.0}, kStart),
                         Trajectory::brake(0.0, -7.0, 40.0, kStart)};
  for (const Trajectory& path : paths) {
    for (double t = 0.01; t < in_seconds(path.end() - kStart) - 0.01; t += 0.0373) {
      constexpr double kStep = 1e-4;
      const double slope = (path.position(after(t + kStep)) - path.position(after(t - kStep))) / (2.0 * kStep);
      EXPECT_NEAR(slope, path.velocity(after(t)), 40.0 * kStep)
          << t;  // a kink of the speed lies within a step at worst
    }
  }
}

}  // namespace
}  // namespace gonio::sim
