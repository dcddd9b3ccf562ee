#include "drivers/motion/move_task.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/drivers/stage_states.h"

namespace gonio::drivers {
namespace {

using namespace std::chrono_literals;
using stage::Axis;
using testing::HasSubstr;

constexpr MotionToken kToken = 200;
constexpr Epoch kEpoch = 5;

/// A move of theta_r from 0 to 20: 10 per s and 20 per s^2 make 0.5 s of ramp, 1.5 s at speed, 0.5 s of ramp: 2.5 s.
/// The deadline is 1.5 * (2.5 + 0.1 settle) + 1 = 4.9 s.
class MoveTaskTest : public testing::Test {
 protected:
  static constexpr std::size_t kThetaR = stage::index_of(Axis::ThetaR);

  static MotionTarget target() {
    MotionTarget t;
    t[kThetaR] = 20.0;
    return t;
  }

  Result<MotionProgress> look_at(Duration t, const StageState& state) { return task.look(state, start + t); }

  // What every look must show unless the test says otherwise: accepted, theta_r at `position`.
  static StageState seen(double position, bool moving) {
    StageState state = test::resting_state();
    state.accepted_token = kToken;
    state.axes[kThetaR].position = position;
    state.axes[kThetaR].moving = moving;
    return state;
  }

  void expect_failure(const StageState& state, ErrorCode code, const std::string& words) {
    const auto looked = look_at(1s, state);
    ASSERT_FALSE(looked.has_value());
    EXPECT_EQ(looked.error().code, code);
    EXPECT_THAT(describe(looked.error()), HasSubstr(words));
    EXPECT_THAT(looked.error().tried, HasSubstr("theta_r to 20.000 deg"));
  }

  Instant start{1000s};
  StageConfig config = test::simple_config();
  MoveTask task{config, test::resting_state(), target(), kToken, kEpoch, start};
};

TEST_F(MoveTaskTest, ComputesArrivalAndDeadlineFromTheMotion) {
  EXPECT_EQ(task.first_look() - start, 0ms);
  EXPECT_EQ(task.predicted_arrival() - start, 2500ms);
  EXPECT_EQ(task.deadline() - start, 4900ms);
}

TEST_F(MoveTaskTest, CountsTheTravelFromTheLookThatSawItAccepted) {
  StageState not_yet = test::resting_state();
  ASSERT_TRUE(look_at(0ms, not_yet));

  ASSERT_TRUE(look_at(40ms, seen(0.0, true)));

  EXPECT_EQ(task.predicted_arrival() - start, 2540ms);
}

TEST_F(MoveTaskTest, LooksAtALongMoveNowAndThen) {
  const auto accepted = look_at(0ms, seen(0.0, true));

  ASSERT_TRUE(accepted);
  EXPECT_EQ(accepted->next_look - start, MoveTask::kLongestUnseen);
}

TEST_F(MoveTaskTest, LooksAgainWhenAShortMoveShouldBeOver) {
  MotionTarget near;
  near[kThetaR] = 0.05;  // 2 sqrt(0.05 / 20) = 0.1 s
  MoveTask quick(config, test::resting_state(), near, kToken, kEpoch, start);

  const auto accepted = quick.look(seen(0.0, true), start + 2ms);

  ASSERT_TRUE(accepted);
  EXPECT_EQ(accepted->next_look - start, 102ms);
}

TEST_F(MoveTaskTest, IsDoneAtTheFirstLookWhenItIsThereAndNeedsNoSettling) {
  config.axes[kThetaR].settle = 0ms;
  MoveTask instant(config, test::resting_state(), target(), kToken, kEpoch, start);

  const auto looked = instant.look(seen(20.0, false), start);

  ASSERT_TRUE(looked);
  EXPECT_TRUE(looked->is_done);
}

TEST_F(MoveTaskTest, IsDoneWhenTheAxisStayedInItsWindowForTheSettleTime) {
  const auto arrived = look_at(2500ms, seen(20.005, false));
  const auto half_way = look_at(2550ms, seen(19.995, false));
  const auto settled = look_at(2600ms, seen(20.0, false));

  ASSERT_TRUE(arrived && half_way && settled);
  EXPECT_FALSE(arrived->is_done);
  EXPECT_FALSE(half_way->is_done);
  EXPECT_TRUE(settled->is_done);
}

TEST_F(MoveTaskTest, AsksForTheLookAtWhichSettlingEnds) {
  ASSERT_TRUE(look_at(2500ms, seen(20.0, false)));

  const auto near_the_end = look_at(2590ms, seen(20.0, false));

  ASSERT_TRUE(near_the_end);
  EXPECT_EQ(near_the_end->next_look - start, 2600ms);
}

TEST_F(MoveTaskTest, BeginsToSettleAnewWhenTheAxisLeftItsWindow) {
  ASSERT_TRUE(look_at(2500ms, seen(20.0, false)));
  ASSERT_TRUE(look_at(2550ms, seen(20.02, false)));
  ASSERT_TRUE(look_at(2580ms, seen(20.0, false)));

  const auto too_early = look_at(2620ms, seen(20.0, false));
  const auto settled = look_at(2680ms, seen(20.0, false));

  ASSERT_TRUE(too_early && settled);
  EXPECT_FALSE(too_early->is_done);
  EXPECT_TRUE(settled->is_done);
}

TEST_F(MoveTaskTest, DoesNotTakeADriveThatSaysDoneTooEarlyAtItsWord) {
  const auto says_done = look_at(1s, seen(7.5, false));
  const auto long_after = look_at(2s, seen(15.0, false));

  ASSERT_TRUE(says_done && long_after);
  EXPECT_FALSE(says_done->is_done);
  EXPECT_FALSE(long_after->is_done);
}

TEST_F(MoveTaskTest, DoesNotCountAnAxisThatCreepsThroughItsWindowAsArrived) {
  ASSERT_TRUE(look_at(2400ms, seen(19.995, true)));

  const auto later = look_at(2550ms, seen(20.0, true));

  ASSERT_TRUE(later);
  EXPECT_FALSE(later->is_done);
}

TEST_F(MoveTaskTest, IsNotDoneBeforeTheStageHasAcceptedTheCommand) {
  StageState old_command = seen(20.0, false);
  old_command.accepted_token = 100;

  const auto first = look_at(2500ms, old_command);
  const auto later = look_at(2700ms, old_command);

  ASSERT_TRUE(first && later);
  EXPECT_FALSE(later->is_done);
}

TEST_F(MoveTaskTest, SaysWhereTheAxisIsWhenItIsLate) {
  const auto late = look_at(4900ms, seen(19.5, true));

  ASSERT_FALSE(late.has_value());
  EXPECT_EQ(late.error().code, ErrorCode::MotionLate);
  EXPECT_THAT(late.error().seen, HasSubstr("theta_r is at 19.5000 deg and still moving"));
  EXPECT_THAT(late.error().limit, HasSubstr("20.0000 +- 0.0100 deg within 4.900 s"));
}

TEST_F(MoveTaskTest, LetsAnAxisThatIsInPlaceSettleWhenTheLookItselfCameLate) {
  const auto first_look = look_at(60s, seen(20.0, false));
  const auto settled = look_at(60s + 100ms, seen(20.0, false));

  ASSERT_TRUE(first_look && settled);
  EXPECT_FALSE(first_look->is_done);
  EXPECT_TRUE(settled->is_done);
}

TEST_F(MoveTaskTest, IsLateWhenAnAxisKeepsLeavingItsWindow) {
  Duration t = 4900ms;
  Result<MotionProgress> looked = look_at(t, seen(20.0, false));
  for (int i = 0; i < 10 && looked; ++i) looked = look_at(t += 30ms, seen(i % 2 == 0 ? 20.02 : 20.0, false));

  ASSERT_FALSE(looked.has_value());
  EXPECT_EQ(looked.error().code, ErrorCode::MotionLate);
}

TEST_F(MoveTaskTest, WaitsForEveryNamedAxis) {
  MotionTarget both = target();
  both[stage::index_of(Axis::Carriage)] = 5.0;
  MoveTask two(config, test::resting_state(), both, kToken, kEpoch, start);

  ASSERT_TRUE(two.look(seen(20.0, false), start + 2500ms));
  const auto one_is_there = two.look(seen(20.0, false), start + 2700ms);

  ASSERT_TRUE(one_is_there);
  EXPECT_FALSE(one_is_there->is_done);
}

TEST_F(MoveTaskTest, IsStoppedWhenSomebodyElseStoppedTheStageAndResetIt) {
  StageState state = seen(12.0, false);
  state.stop_count = 4;

  expect_failure(state, ErrorCode::Stopped, "stop count 4");
}

TEST_F(MoveTaskTest, IsStoppedWhileTheLatchStands) {
  StageState state = seen(12.0, false);
  state.halted = true;

  expect_failure(state, ErrorCode::Stopped, "halted");
}

TEST_F(MoveTaskTest, NamesTheFaultBeforeTheStopThatFollowedFromIt) {
  StageState state = seen(12.0, false);
  state.halted = true;
  state.stop_count = 4;
  state.fault = 2;
  state.axes[kThetaR].fault = 1;

  expect_failure(state, ErrorCode::DeviceFault, "fault 2 (drive fault), axis theta_r fault 1 (following error)");
}

TEST_F(MoveTaskTest, NamesTheMissedHeartbeatBeforeTheStop) {
  StageState state = seen(12.0, false);
  state.stop_count = 4;
  state.heartbeat_tripped = true;

  expect_failure(state, ErrorCode::HeartbeatTripped, "not heard");
}

TEST_F(MoveTaskTest, NamesTheInterlockBeforeTheStop) {
  StageState state = seen(12.0, false);
  state.stop_count = 4;
  state.interlock_open = true;

  expect_failure(state, ErrorCode::Interlock, "interlock");
}

TEST_F(MoveTaskTest, HasLostThePositionWhenTheStageWasPoweredUpAnew) {
  StageState state = seen(20.0, false);
  state.boot_counter = 8;

  expect_failure(state, ErrorCode::PositionLost, "boot counter 8");
}

TEST_F(MoveTaskTest, NeedsHomedAxes) {
  StageState state = seen(20.0, false);
  state.axes[kThetaR].homed = false;

  expect_failure(state, ErrorCode::NotHomed, "theta_r");
}

TEST_F(MoveTaskTest, FailsWhenTheStageObeysSomebodyElsesCommand) {
  StageState state = seen(12.0, true);
  state.accepted_token = 555;

  expect_failure(state, ErrorCode::ControlLost, "command 555");
}

TEST_F(MoveTaskTest, SaysWhatTheStageRefusedTheCommandFor) {
  const std::vector<std::pair<stage::Refusal, ErrorCode>> refusals{
      {stage::Refusal::EpochTooOld, ErrorCode::StaleEpoch},
      {stage::Refusal::Halted, ErrorCode::Stopped},
      {stage::Refusal::HeartbeatTripped, ErrorCode::HeartbeatTripped},
      {stage::Refusal::NotHomed, ErrorCode::NotHomed},
      {stage::Refusal::BeyondLimit, ErrorCode::DeviceRefused},
      {stage::Refusal::Fault, ErrorCode::DeviceFault},
      {stage::Refusal::InterlockOpen, ErrorCode::Interlock},
      {stage::Refusal::AlreadyMoving, ErrorCode::DeviceRefused},
      {stage::Refusal::BadCommand, ErrorCode::DeviceRefused},
  };
  for (const auto& [refusal, code] : refusals) {
    SCOPED_TRACE(stage::refusal_name(refusal));
    StageState state = test::resting_state();
    state.refused_token = kToken;
    state.refusal = refusal;

    expect_failure(state, code, std::string(stage::refusal_name(refusal)));
  }
}

TEST_F(MoveTaskTest, TakesACommandThatWasWrittenTwiceAsAccepted) {
  StageState state = seen(12.0, true);
  state.refused_token = kToken;
  state.refusal = stage::Refusal::AlreadyMoving;

  EXPECT_TRUE(look_at(1s, state).has_value());
}

TEST_F(MoveTaskTest, IsLateWhenTheCommandIsNeitherAcceptedNorRefused) {
  const auto late = look_at(4900ms, test::resting_state());

  ASSERT_FALSE(late.has_value());
  EXPECT_EQ(late.error().code, ErrorCode::MotionLate);
  EXPECT_THAT(late.error().seen, HasSubstr("neither accepted nor refused"));
}

}  // namespace
}  // namespace gonio::drivers
