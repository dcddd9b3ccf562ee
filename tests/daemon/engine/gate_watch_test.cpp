#include "daemon/engine/gate_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gonio::daemon {
namespace {

using namespace std::chrono_literals;
using stage::Axis;
using testing::HasSubstr;

/// Exposure 8 of 200 ms, with theta_r held at 45 +- 0.01 deg; counts of 1e-4 deg. The deadline is 1.5 * 0.2 + 1 = 1.3
/// s.
class GateWatchTest : public testing::Test {
 protected:
  static constexpr std::size_t kThetaR = stage::index_of(Axis::ThetaR);

  GateWatchTest() {
    config.registers.axis_scale.fill(1e-4);
    for (auto& axis : config.axes) axis.window = 0.01;
    config.deadline_factor = 1.5;
    config.deadline_margin = 1s;
    request.after = 7;
    request.expected = 200ms;
    request.held[kThetaR] = 45.0;
  }

  static drivers::StageState seen(std::uint32_t count, bool open) {
    drivers::StageState state;
    state.boot_counter = 3;
    state.gate.count = count;
    state.gate.open = open;
    state.gate.open_counts[kThetaR] = 450000;
    state.gate.close_counts[kThetaR] = 450000;
    return state;
  }

  Result<drivers::MotionProgress> look(const drivers::StageState& state, Duration t) {
    return GateWatch(config, request, 3, start).look(state, start + t);
  }

  void expect_failure(const Result<drivers::MotionProgress>& looked, ErrorCode code, const std::string& words) {
    ASSERT_FALSE(looked.has_value());
    EXPECT_EQ(looked.error().code, code);
    EXPECT_THAT(describe(looked.error()), HasSubstr(words));
  }

  Instant start{1000s};
  drivers::StageConfig config;
  WatchGate request;
};

TEST_F(GateWatchTest, LooksFirstWhenTheExposureShouldBeOver) {
  EXPECT_EQ(GateWatch(config, request, 3, start).first_look() - start, 200ms);
}

TEST_F(GateWatchTest, IsDoneWhenTheNextExposureWasCountedAndClosed) {
  const auto looked = look(seen(8, false), 200ms);

  ASSERT_TRUE(looked);
  EXPECT_TRUE(looked->is_done);
}

TEST_F(GateWatchTest, WaitsWhileTheExposureIsUnderWay) {
  const auto looked = look(seen(8, true), 200ms);

  ASSERT_TRUE(looked);
  EXPECT_FALSE(looked->is_done);
  EXPECT_EQ(looked->next_look - start, 200ms + 100us);  // as late as it is: close looks at first

  const auto later = look(seen(8, true), 220ms);
  const auto much_later = look(seen(8, true), 400ms);

  ASSERT_TRUE(later && much_later);
  EXPECT_EQ(later->next_look - start, 225ms);
  EXPECT_EQ(much_later->next_look - start, 420ms);  // an eighth of the exposure, 20 ms at most
}

TEST_F(GateWatchTest, WaitsForAnExposureThatHasNotBegun) {
  const auto looked = look(seen(7, false), 200ms);

  ASSERT_TRUE(looked);
  EXPECT_FALSE(looked->is_done);
}

TEST_F(GateWatchTest, RefusesMoreThanOneExposure) {
  expect_failure(look(seen(9, false), 200ms), ErrorCode::StaleData, "2 exposures counted");
}

TEST_F(GateWatchTest, CountsAcrossTheEndOfTheCounter) {
  request.after = 0xFFFFFFFF;

  const auto looked = look(seen(0, false), 200ms);

  ASSERT_TRUE(looked);
  EXPECT_TRUE(looked->is_done);
}

TEST_F(GateWatchTest, TimesOutByTheExposureAndSaysHowTheGateStands) {
  expect_failure(look(seen(8, true), 1300ms), ErrorCode::TimedOut, "gate count 8, gate still open");
}

TEST_F(GateWatchTest, RefusesAPositionThatWasOffWhenTheExposureBegan) {
  drivers::StageState state = seen(8, false);
  state.gate.open_counts[kThetaR] = 449850;

  expect_failure(look(state, 200ms), ErrorCode::OutOfTolerance, "theta_r at 44.9850 deg when it began");
}

TEST_F(GateWatchTest, RefusesAPositionThatWasOffWhenTheExposureEnded) {
  drivers::StageState state = seen(8, false);
  state.gate.close_counts[kThetaR] = 450101;

  expect_failure(look(state, 200ms), ErrorCode::OutOfTolerance, "45.0000 +- 0.0100 deg");
}

TEST_F(GateWatchTest, LeavesAxesAloneThatNeedNotHold) {
  drivers::StageState state = seen(8, false);
  state.gate.close_counts[stage::index_of(Axis::ThetaI)] = 123456;

  EXPECT_TRUE(look(state, 200ms).has_value());
}

TEST_F(GateWatchTest, HasLostThePositionWhenTheStageWasPoweredUpAnew) {
  drivers::StageState state = seen(0, false);
  state.boot_counter = 4;

  expect_failure(look(state, 200ms), ErrorCode::PositionLost, "boot counter 4");
}

TEST_F(GateWatchTest, ReportsAFaultOfTheStage) {
  drivers::StageState state = seen(8, false);
  state.fault = 4;

  expect_failure(look(state, 200ms), ErrorCode::DeviceFault, "encoder fault");
}

}  // namespace
}  // namespace gonio::daemon
