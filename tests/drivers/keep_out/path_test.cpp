#include <gtest/gtest.h>

#include <random>

#include "drivers/keep_out/path_conflict.h"
#include "drivers/motion/axis_profile.h"
#include "drivers/motion/route.h"
#include "drivers/motion/route_time.h"
#include "tests/drivers/keep_out/arms_on_a_bench.h"

namespace gonio::drivers {
namespace {

using stage::Axis;
using stage::index_of;
using test::arms_on_a_bench;
using test::smallest_angle;

constexpr unsigned kSeed = 20260817;
constexpr int kMoves = 10000;

struct RandomMove {
  stage::PerAxis<double> from{};
  MotionTarget to{};
};

/// Moves whose two ends are clear, anywhere within the limits.
class RandomMoves {
 public:
  explicit RandomMoves(const StageConfig& config) : config_(config) {}

  RandomMove next() {
    RandomMove move;
    move.from = clear_place();
    const auto to = clear_place();
    for (std::size_t a = 0; a < 4; ++a) move.to[a] = to[a];
    return move;
  }

 private:
  stage::PerAxis<double> clear_place() {
    stage::PerAxis<double> at{};
    do {
      for (std::size_t a = 0; a < 4; ++a) {
        at[a] = std::uniform_real_distribution<double>(config_.axes[a].low, config_.axes[a].high)(chance_);
      }
    } while (test::angle_between_arms(at) < config_.keep_out->least_separation() + kPathResolution);
    return at;
  }

  const StageConfig& config_;
  std::mt19937_64 chance_{kSeed};
};

TEST(AxisProfile, IsTheSimulatorsTrajectory) {
  const AxisConfig how{.speed = 13.0, .acceleration = 60.0};
  for (const auto& [from, to] :
       {std::pair(3.0, 80.0), std::pair(80.0, 3.0), std::pair(5.0, 6.0), std::pair(7.0, 7.0)}) {
    const AxisProfile ours(from, to, how);
    const auto theirs = sim::Trajectory::move(from, to, {how.speed, how.acceleration}, Instant{});
    for (int k = -1; k <= 200; ++k) {
      const double t = 0.035 * k;
      EXPECT_NEAR(ours.position(t), theirs.position(Instant{seconds(t)}), 1e-7) << from << " to " << to << " at " << t;
    }
  }
}

TEST(PathConflict, AgreesWithDenseSamplesOfTenThousandRandomMoves) {
  SCOPED_TRACE(kSeed);
  const StageConfig config = arms_on_a_bench();
  const Angle least = config.keep_out->least_separation();
  RandomMoves moves(config);
  int blocked = 0;
  for (int k = 0; k < kMoves; ++k) {
    const RandomMove move = moves.next();
    const auto conflict = path_conflict(config, move.from, move.to);
    const Angle sampled = smallest_angle(config, move.from, move.to, conflict ? 3000 : 300);
    if (conflict) {
      ++blocked;
      // A blocked one comes nearer than the margin of the search allows; samples lie up to 0.1 deg apart.
      EXPECT_LT(sampled, least + kPathResolution + degrees(0.1)) << "move " << k;
      EXPECT_NEAR(conflict->separation.si(), test::angle_between_arms(conflict->at).si(), 1e-7);
      EXPECT_LT(conflict->separation, least + kPathResolution);
    } else {
      EXPECT_GE(sampled + radians(1e-7), least) << "move " << k;
    }
  }
  RecordProperty("blocked", blocked);
  EXPECT_GT(blocked, kMoves / 50);
  EXPECT_LT(blocked, kMoves / 2);
}

TEST(PathConflict, FindsTheMeetingOfArmsThatAreFarApartAtBothEnds) {
  const StageConfig config = arms_on_a_bench();
  const stage::PerAxis<double> from{40.0, 20.0, 0.0, 0.0, 0.0, 1.0};
  MotionTarget to;
  to[index_of(Axis::ThetaR)] = 60.0;

  const auto conflict = path_conflict(config, from, to);

  ASSERT_TRUE(conflict);
  EXPECT_LT(conflict->separation, conflict->least);
  EXPECT_GT(conflict->at[index_of(Axis::ThetaR)], 28.0);
  EXPECT_LT(conflict->at[index_of(Axis::ThetaR)], 52.0);
}

TEST(PathConflict, LetsAMoveLeadOutOfTheKeepOutButNotDeeper) {
  const StageConfig config = arms_on_a_bench();
  const stage::PerAxis<double> home{0.0, 0.0, 0.0, 0.0, 0.0, 1.0};
  const stage::PerAxis<double> near{40.0, 35.0, 0.0, 0.0, 0.0, 1.0};
  MotionTarget out;
  out[index_of(Axis::ThetaR)] = 60.0;
  MotionTarget back;
  back[index_of(Axis::ThetaR)] = 10.0;

  EXPECT_FALSE(path_conflict(config, home, out));
  EXPECT_TRUE(path_conflict(config, near, out));  // through the source's arm
  EXPECT_FALSE(path_conflict(config, near, back));
}

TEST(PathConflict, CostsNothingWithoutAKeepOutOrWithoutMovingArms) {
  StageConfig config = arms_on_a_bench();
  MotionTarget carriage;
  carriage[index_of(Axis::Carriage)] = 100.0;
  EXPECT_FALSE(path_conflict(config, {30.0, 30.0, 0.0, 0.0, 0.0, 1.0}, carriage));

  config.keep_out.reset();
  MotionTarget into;
  into[index_of(Axis::ThetaR)] = 40.0;
  EXPECT_FALSE(path_conflict(config, {40.0, 0.0, 0.0, 0.0, 0.0, 1.0}, into));
}

TEST(PathConflict, ATurningSampleMeetsItsDetectorArmAtTheSourceOnly) {
  StageConfig config = arms_on_a_bench();
  config.kinematics.kind = KinematicsKind::TurningSample;
  config.axes[index_of(Axis::ThetaR)].low = -160.0;
  MotionTarget across;
  across[index_of(Axis::ThetaR)] = -30.0;  // the detector's arm, past the source at 0
  MotionTarget yaw;
  yaw[index_of(Axis::ThetaI)] = 70.0;

  EXPECT_TRUE(path_conflict(config, {0.0, 30.0, 0.0, 0.0, 0.0, 1.0}, across));
  EXPECT_FALSE(path_conflict(config, {0.0, 30.0, 0.0, 0.0, 0.0, 1.0}, yaw));
}

TEST(Detour, EveryLegOfEveryWayRoundIsClearBySamples) {
  SCOPED_TRACE(kSeed);
  const StageConfig config = arms_on_a_bench();
  const Angle least = config.keep_out->least_separation();
  RandomMoves moves(config);
  int round = 0;
  int refused = 0;
  for (int k = 0; k < kMoves / 4; ++k) {
    const RandomMove move = moves.next();
    const auto legs = plan_route(config, move.from, move.to, {});
    refused += legs ? 0 : 1;
    if (!legs || legs->size() == 1) continue;
    ++round;
    stage::PerAxis<double> at = move.from;
    for (const MotionTarget& leg : *legs) {
      EXPECT_GE(smallest_angle(config, at, leg, 300) + radians(1e-7), least) << "move " << k;
      at = after(at, leg);
    }
    for (std::size_t a = 0; a < 4; ++a) EXPECT_EQ(at[a], *move.to[a]);
  }
  RecordProperty("round", round);
  RecordProperty("refused", refused);
  EXPECT_GT(round, 20);
  EXPECT_LT(refused, round / 20 + 1);
}

}  // namespace
}  // namespace gonio::drivers
