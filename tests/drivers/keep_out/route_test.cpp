#include "drivers/motion/route.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/motion/route_time.h"
#include "tests/drivers/keep_out/arms_on_a_bench.h"

namespace gonio::drivers {
namespace {

using stage::Axis;
using stage::index_of;
using testing::HasSubstr;

constexpr std::size_t kThetaR = index_of(Axis::ThetaR);

SlackTakenUp all_taken_up() {
  SlackTakenUp taken_up{};
  taken_up.fill(true);
  return taken_up;
}

MotionTarget theta_r_to(double position) {
  MotionTarget target;
  target[kThetaR] = position;
  return target;
}

/// A stage without keep-out whose theta_r arrives from below, going past by 0.5 deg.
class ApproachRoute : public testing::Test {
 protected:
  ApproachRoute() {
    config.keep_out.reset();
    config.axes[kThetaR].approach = Approach::FromBelow;
    config.axes[kThetaR].overrun = 0.5;
  }

  // Where theta_r stops on the way, the target included.
  std::vector<double> stops(double from, double to, const SlackTakenUp& taken_up = all_taken_up()) {
    stage::PerAxis<double> standing{};
    standing[kThetaR] = from;
    const auto legs = plan_route(config, standing, theta_r_to(to), taken_up);
    EXPECT_TRUE(legs) << describe(legs.error());
    std::vector<double> at;
    for (const MotionTarget& leg : *legs) at.push_back(*leg[kThetaR]);
    return at;
  }

  StageConfig config = test::arms_on_a_bench();
};

TEST_F(ApproachRoute, GoesStraightWhenItArrivesFromItsSide) {
  EXPECT_EQ(stops(10.0, 40.0), std::vector{40.0});
}

TEST_F(ApproachRoute, GoesPastAndReturnsWhenItWouldArriveFromTheOtherSide) {
  EXPECT_EQ(stops(60.0, 40.0), (std::vector{39.5, 40.0}));
}

TEST_F(ApproachRoute, AShortWayFromItsSideIsEnoughOnlyWithTheSlackTakenUp) {
  EXPECT_EQ(stops(39.8, 40.0), std::vector{40.0});
  EXPECT_EQ(stops(39.8, 40.0, {}), (std::vector{39.5, 40.0}));
}

TEST_F(ApproachRoute, StayingWhereItIsTakesTheSlackUpWhenThatIsNotKnown) {
  EXPECT_EQ(stops(40.0, 40.0), std::vector{40.0});
  EXPECT_EQ(stops(40.0, 40.0, {}), (std::vector{39.5, 40.0}));
}

TEST_F(ApproachRoute, FromAboveIsTheMirrorImage) {
  config.axes[kThetaR].approach = Approach::FromAbove;

  EXPECT_EQ(stops(60.0, 40.0), std::vector{40.0});
  EXPECT_EQ(stops(10.0, 40.0), (std::vector{40.5, 40.0}));
}

TEST_F(ApproachRoute, TheTimeOfAMoveHoldsBothLegs) {
  stage::PerAxis<double> standing{};
  standing[kThetaR] = 60.0;
  const auto legs = plan_route(config, standing, theta_r_to(40.0), all_taken_up());

  // By hand: 20.5 deg at 13 deg/s and 60 deg/s^2: 20.5/13 + 13/60 s; then 0.5 deg: 2 sqrt(0.5/60) s.
  EXPECT_NEAR(in_seconds(route_time(config, standing, *legs)), 20.5 / 13.0 + 13.0 / 60.0 + 2.0 * std::sqrt(0.5 / 60.0),
              1e-8);
}

TEST_F(ApproachRoute, RefusesATargetWithoutRoomToTurnFromWhereverItComes) {
  const auto legs = plan_route(config, {}, theta_r_to(0.2), all_taken_up());

  ASSERT_FALSE(legs);
  EXPECT_EQ(legs.error().code, ErrorCode::OutOfLimits);
  EXPECT_EQ(legs.error().tried, "move theta_r to 0.200 deg from below");
  EXPECT_EQ(legs.error().seen, "it would turn at -0.300 deg");
  EXPECT_EQ(legs.error().limit, "0.000 to 85.000 deg");
}

TEST(KeepOutRoute, ArrivesFromItsSideAlsoAfterAWayRound) {
  StageConfig config = test::arms_on_a_bench();
  config.axes[kThetaR].approach = Approach::FromBelow;
  config.axes[kThetaR].overrun = 0.5;
  const stage::PerAxis<double> standing{40.0, 20.0, 0.0, 0.0, 0.0, 1.0};

  const auto legs = plan_route(config, standing, theta_r_to(60.0), all_taken_up());

  ASSERT_TRUE(legs) << describe(legs.error());
  ASSERT_GE(legs->size(), 3U);
  EXPECT_EQ(*(*legs)[legs->size() - 2][kThetaR], 59.5);
  EXPECT_EQ(*legs->back()[kThetaR], 60.0);
  EXPECT_EQ(*legs->back()[index_of(Axis::PhiR)], 0.0);  // swung aside and back
}

TEST(KeepOutRoute, RefusesAnEndWithTheArmsTogetherAndNamesThePlace) {
  const StageConfig config = test::arms_on_a_bench();

  const auto legs = plan_route(config, {40.0, 10.0, 0.0, 0.0, 0.0, 1.0}, theta_r_to(38.0), all_taken_up());

  ASSERT_FALSE(legs);
  EXPECT_EQ(legs.error().code, ErrorCode::Blocked);
  EXPECT_THAT(legs.error().seen, HasSubstr("theta_r 38.000"));
  EXPECT_THAT(legs.error().seen, HasSubstr("2.000 deg of each other"));
  EXPECT_THAT(legs.error().limit, HasSubstr("at least 11.00"));
}

}  // namespace
}  // namespace gonio::drivers
