#include "drivers/motion/shutter_task.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/drivers/stage_states.h"

namespace gonio::drivers {
namespace {

using namespace std::chrono_literals;
using stage::ShutterState;
using testing::HasSubstr;

class ShutterTaskTest : public testing::Test {
 protected:
  static StageState with(ShutterState source, ShutterState detector) {
    StageState state = test::resting_state();
    state.source_shutter = source;
    state.detector_shutter = detector;
    return state;
  }

  Instant start{1000s};
  ShutterTask task{test::simple_config(), test::resting_state(), true, false, start};
};

TEST_F(ShutterTaskTest, IsDoneWhenBothStandAsAsked) {
  const auto looked = task.look(with(ShutterState::Open, ShutterState::Closed), start);

  ASSERT_TRUE(looked);
  EXPECT_TRUE(looked->is_done);
}

TEST_F(ShutterTaskTest, WaitsWhileOneMoves) {
  const auto looked = task.look(with(ShutterState::Moving, ShutterState::Closed), start + 1s);

  ASSERT_TRUE(looked);
  EXPECT_FALSE(looked->is_done);
}

TEST_F(ShutterTaskTest, SaysHowTheyStandWhenItIsLate) {
  const auto late = task.look(with(ShutterState::Moving, ShutterState::Closed), start + 2s);

  ASSERT_FALSE(late.has_value());
  EXPECT_EQ(late.error().code, ErrorCode::MotionLate);
  EXPECT_THAT(late.error().seen, HasSubstr("source shutter moving"));
}

TEST_F(ShutterTaskTest, EndsTheSameWayAfterAStop) {
  StageState state = with(ShutterState::Open, ShutterState::Closed);
  state.halted = true;
  state.stop_count = 4;

  const auto looked = task.look(state, start + 1s);

  ASSERT_TRUE(looked);
  EXPECT_TRUE(looked->is_done);
}

TEST_F(ShutterTaskTest, IsLostWithThePowerOfTheStage) {
  StageState state = with(ShutterState::Open, ShutterState::Closed);
  state.boot_counter = 8;

  const auto looked = task.look(state, start + 1s);

  ASSERT_FALSE(looked.has_value());
  EXPECT_EQ(looked.error().code, ErrorCode::PositionLost);
}

}  // namespace
}  // namespace gonio::drivers
