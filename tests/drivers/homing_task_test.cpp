#include "drivers/motion/homing_task.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/drivers/stage_states.h"

namespace gonio::drivers {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class HomingTaskTest : public testing::Test {
 protected:
  static StageState homed() {
    StageState state = test::resting_state();
    state.accepted_token = 200;
    return state;
  }

  Instant start{1000s};
  HomingTask task{test::simple_config(), test::resting_state(), 200, 5, start};
};

TEST_F(HomingTaskTest, IsDoneWhenAllAxesAreHomedAndAtRest) {
  const auto looked = task.look(homed(), start + 5s);

  ASSERT_TRUE(looked);
  EXPECT_TRUE(looked->is_done);
}

TEST_F(HomingTaskTest, WaitsForTheLastAxis) {
  StageState state = homed();
  state.axes[2].homed = false;

  const auto looked = task.look(state, start + 5s);

  ASSERT_TRUE(looked);
  EXPECT_FALSE(looked->is_done);
}

TEST_F(HomingTaskTest, DoesNotTakeTheHomedStateOfBeforeForItsOwn) {
  const auto looked = task.look(test::resting_state(), start + 1s);

  ASSERT_TRUE(looked);
  EXPECT_FALSE(looked->is_done);
}

TEST_F(HomingTaskTest, NamesTheAxisThatIsNotHomedInTime) {
  StageState state = homed();
  state.axes[2].homed = false;

  const auto late = task.look(state, start + 30s);

  ASSERT_FALSE(late.has_value());
  EXPECT_EQ(late.error().code, ErrorCode::MotionLate);
  EXPECT_THAT(describe(late.error()), HasSubstr("phi_r is not homed"));
}

TEST_F(HomingTaskTest, IsStoppedBySomebodyElse) {
  StageState state = homed();
  state.stop_count = 9;

  const auto looked = task.look(state, start + 5s);

  ASSERT_FALSE(looked.has_value());
  EXPECT_EQ(looked.error().code, ErrorCode::Stopped);
}

}  // namespace
}  // namespace gonio::drivers
