// Coordinated moves: a straight line in axis space, proven and timed as such.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "drivers/keep_out/path_conflict.h"
#include "drivers/motion/axis_profile.h"
#include "drivers/motion/leg_axes.h"
#include "drivers/motion/route.h"
#include "drivers/motion/route_time.h"
#include "tests/drivers/keep_out/arms_on_a_bench.h"
#include "tests/sim/bench.h"

namespace gonio::drivers {
namespace {

using stage::Axis;
using stage::index_of;
using Places = stage::PerAxis<double>;

constexpr unsigned kSeed = 20261122;
constexpr int kMoves = 2000;

StageConfig coordinated_arms() {
  StageConfig config = test::arms_on_a_bench();
  config.coordinated = true;
  return config;
}

MotionTarget arms_to(double theta_i, double theta_r) {
  MotionTarget target;
  target[index_of(Axis::ThetaI)] = theta_i;
  target[index_of(Axis::ThetaR)] = theta_r;
  return target;
}

Places anywhere(const StageConfig& config, std::mt19937_64& chance) {
  Places at{};
  for (std::size_t a = 0; a < 4; ++a) {
    at[a] = std::uniform_real_distribution<double>(config.axes[a].low, config.axes[a].high)(chance);
  }
  return at;
}

Places on_the_line(const Places& from, const Places& to, double part) {
  Places at{};
  for (std::size_t a = 0; a < at.size(); ++a) at[a] = from[a] + part * (to[a] - from[a]);
  return at;
}

Angle smallest_on_the_line(const Places& from, const Places& to, int samples) {
  Angle smallest = radians(std::numbers::pi);
  for (int k = 0; k <= samples; ++k) {
    smallest = std::min(smallest, test::angle_between_arms(on_the_line(from, to, static_cast<double>(k) / samples)));
  }
  return smallest;
}

TEST(CoordinatedLeg, KeepsEveryAxisOnTheLineAndWithinWhatItCanDo) {
  SCOPED_TRACE(kSeed);
  const StageConfig config = coordinated_arms();
  std::mt19937_64 chance(kSeed);
  for (int k = 0; k < 200; ++k) {
    const Places from = anywhere(config, chance);
    const Places to = anywhere(config, chance);
    MotionTarget leg;
    for (std::size_t a = 0; a < 4; ++a) leg[a] = to[a];

    const auto axes = axes_on_leg(config, from, leg);

    const double end_s = in_seconds(leg_time(config, from, leg));
    for (std::size_t a = 0; a < 4; ++a) {
      EXPECT_LE(axes[a].speed, config.axes[a].speed * (1.0 + 1e-12));
      EXPECT_LE(axes[a].acceleration, config.axes[a].acceleration * (1.0 + 1e-12));
      const AxisProfile profile(from[a], to[a], axes[a]);
      EXPECT_NEAR(profile.duration_s(), end_s, 1e-6);
      const AxisProfile first(from[0], to[0], axes[0]);
      for (int part = 1; part < 10; ++part) {
        const double t = 0.1 * part * end_s;
        EXPECT_NEAR((profile.position(t) - from[a]) * (to[0] - from[0]),
                    (first.position(t) - from[0]) * (to[a] - from[a]),
                    1e-5 * std::abs((to[0] - from[0]) * (to[a] - from[a])) + 1e-9);
      }
    }
  }
}

// theta_r limits the speed (13 of 30 deg a second) and theta_i the acceleration (40 of 30 deg): 30/13 +
// (13/30)/(40/30).
TEST(CoordinatedLeg, LastsByTheSlowestSpeedAndTheSlowestAcceleration) {
  const MotionTarget target = arms_to(55.0, 70.0);
  const std::vector<MotionTarget> legs{target};

  EXPECT_NEAR(in_seconds(route_time(coordinated_arms(), {25.0, 40.0, 0.0, 0.0, 0.0, 1.0}, legs)), 30.0 / 13.0 + 0.325,
              1e-8);
}

TEST(CoordinatedLeg, OfOneAxisIsThatAxisOwnMove) {
  MotionTarget target;
  target[index_of(Axis::PhiR)] = 90.0;

  EXPECT_EQ(leg_time(coordinated_arms(), {}, target), leg_time(test::arms_on_a_bench(), {}, target));
}

// What is proven and timed here is what a stage does that is told to move together.
TEST(CoordinatedLeg, IsWhatTheSimulatedStageMakesOfIt) {
  sim::test::Bench bench;
  bench.home();
  StageConfig config = coordinated_arms();
  for (std::size_t a = 0; a < stage::kAxisCount; ++a) {
    const sim::AxisSpec& spec = bench.instrument.scene().stage.axes[a];
    config.axes[a].speed = spec.speed;
    config.axes[a].acceleration = spec.acceleration;
  }
  const Places from{0.0, 0.0, 0.0, 0.0, 0.0, 1.0};
  const Places to{50.0, 3.0, -120.0, 0.0, 200.0, 3.0};
  MotionTarget leg;
  const stage::Block block = bench.map().motion_block();
  std::vector<std::uint16_t> words(block.count, 0);
  for (const Axis axis : stage::kAllAxes) {
    const std::size_t a = index_of(axis);
    leg[a] = to[a];
    stage::encode(words, block.first, bench.map().at(axis, stage::AxisField::Target),
                  std::llround(to[a] / bench.map().axis_scale[a]));
  }
  stage::encode(words, block.first, bench.map().at(stage::Field::MotionToken), 77);
  stage::encode(words, block.first, bench.map().at(stage::Field::MotionMask), (1 << stage::kAxisCount) - 1);
  stage::encode(words, block.first, bench.map().at(stage::Field::MotionCommand), stage::kCommandMoveTogether);

  ASSERT_FALSE(bench.face.write(block.first, words, bench.now));

  ASSERT_EQ(bench.refusal(), stage::Refusal::None);
  const auto axes = axes_on_leg(config, from, leg);
  const double end_s = in_seconds(leg_time(config, from, leg));
  for (int k = 1; k <= 20; ++k) {
    bench.wait(0.05 * end_s);
    for (const Axis axis : stage::kAllAxes) {
      const std::size_t a = index_of(axis);
      EXPECT_NEAR(bench.position(axis), AxisProfile(from[a], to[a], axes[a]).position(0.05 * k * end_s), 2e-3)
          << stage::axis_name(axis) << " after " << k << " of 20 parts";
    }
    EXPECT_EQ(bench.has(stage::StatusBit::Moving), k < 20);
  }
}

// The source's arm follows the detector's 15 deg behind. Each by itself, the quicker source comes up to it: a way
// round.
TEST(CoordinatedRoute, IsStraightWhereTheLineIsClearThoughEachAxisByItselfWouldMeetTheOther) {
  const Places standing{25.0, 40.0, 0.0, 0.0, 0.0, 1.0};
  const MotionTarget target = arms_to(55.0, 70.0);

  const auto each_by_itself = plan_route(test::arms_on_a_bench(), standing, target, {});
  const auto together = plan_route(coordinated_arms(), standing, target, {});

  ASSERT_TRUE(each_by_itself && together);
  EXPECT_GT(each_by_itself->size(), 1U);
  ASSERT_EQ(together->size(), 1U);
  EXPECT_EQ(together->front(), target);
}

// And the other way: a source that is far ahead when it goes by itself crosses the detector's arm on the line.
TEST(CoordinatedRoute, IsNotStraightWhereTheLineIsBlocked) {
  const Places standing{40.0, 20.0, 0.0, 0.0, 0.0, 1.0};

  const auto conflict = path_conflict(coordinated_arms(), standing, arms_to(42.0, 70.0));

  ASSERT_TRUE(conflict);
  EXPECT_LT(conflict->separation, conflict->least + kPathResolution);
}

TEST(CoordinatedRoute, IsClearOrBlockedAsDenseSamplesOfTheLineSay) {
  SCOPED_TRACE(kSeed);
  const StageConfig config = coordinated_arms();
  const Angle least = config.keep_out->least_separation();
  std::mt19937_64 chance(kSeed);
  int blocked = 0;
  for (int k = 0; k < kMoves; ++k) {
    const Places from = anywhere(config, chance);
    const Places to = anywhere(config, chance);
    if (test::angle_between_arms(from) < least + kPathResolution) continue;
    MotionTarget target;
    for (std::size_t a = 0; a < 4; ++a) target[a] = to[a];

    const auto conflict = path_conflict(config, from, target);

    const Angle sampled = smallest_on_the_line(from, to, conflict ? 3000 : 300);
    if (conflict) {
      ++blocked;
      EXPECT_LT(sampled, least + kPathResolution + degrees(0.2)) << "move " << k;
    } else {
      EXPECT_GE(sampled + radians(1e-7), least) << "move " << k;
    }
  }
  EXPECT_GT(blocked, kMoves / 50);
}

}  // namespace
}  // namespace gonio::drivers
