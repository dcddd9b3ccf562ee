// Where an arm with play ends up on the simulated stage, whose encoders sit on the motors.
#include <gtest/gtest.h>

#include <cmath>

#include "daemon/config/instrument.h"
#include "daemon/engine/stage_actor.h"
#include "drivers/modbus_stage/modbus_stage.h"
#include "sim/scene/papers.h"
#include "sim/scene/read_scene.h"
#include "sim/wires/live_instrument.h"
#include "tests/support/discrete_executor.h"
#include "tests/support/in_process_modbus_link.h"

namespace gonio::daemon {
namespace {

using namespace std::chrono_literals;
using drivers::Approach;
using stage::Axis;

constexpr std::size_t kThetaR = stage::index_of(Axis::ThetaR);
constexpr double kPlay_deg = 0.2;

sim::Scene with_play() {
  auto scene = sim::read_scene(GONIO_SCENE_DIR "/lambertian.toml");
  EXPECT_TRUE(scene) << describe(scene.error());
  scene->stage.axes[kThetaR].backlash = kPlay_deg;
  return std::move(*scene);
}

/// The daemon's stage thread and driver on a stage whose detector arm has a play of 0.2 deg.
class ArmWithPlay {
 public:
  explicit ArmWithPlay(Approach approach) {
    auto read = parse_instrument(sim::instrument_toml(simulated_.scene(), {}), "instrument.toml");
    EXPECT_TRUE(read) << describe(read.error());
    instrument_ = std::move(*read);
    instrument_.stage.axes[kThetaR].approach = approach;
    instrument_.stage.axes[kThetaR].overrun = 0.5;
    executor_.add("stage", [this](Instant now) { return actor_.step(now); });
    run(Home{1, 1});
  }

  /// Moves the detector's arm; where what it carries then really is, in deg.
  double move_to(double theta_r) {
    MoveTo move{.ticket = 2, .epoch = 1, .target = {}, .source_shutter_open = {}, .detector_shutter_open = {}};
    move.target[kThetaR] = theta_r;
    run(move);
    return simulated_.with([](auto& parts) {
      const sim::StagePose pose = parts.instrument.pose(parts.now);
      return pose.positions[kThetaR] + pose.lags[kThetaR];
    });
  }

 private:
  void run(StageRequest request) {
    answers_.clear();
    executor_.post([this, request](Instant now) { actor_.on(request, now); });
    EXPECT_EQ(executor_.run_until([&] { return !answers_.empty(); }, 1h), test::DiscreteExecutor::Outcome::Reached);
    ASSERT_FALSE(answers_.empty());
    EXPECT_TRUE(answers_[0].state) << describe(answers_[0].state.error());
  }

  ManualClock clock_;
  sim::LiveInstrument simulated_{with_play(), {}, clock_};
  Instrument instrument_;
  test::InProcessModbusLink link_{simulated_};
  drivers::ModbusStage stage_{link_, instrument_.stage, clock_};
  std::vector<StageAnswer> answers_;
  StageActor actor_{stage_, instrument_.stage, [this](StageAnswer a) { answers_.push_back(std::move(a)); }};
  test::DiscreteExecutor executor_{clock_};
};

TEST(Backlash, WithoutAnApproachSideThePlaceDependsOnWhereItCameFrom) {
  ArmWithPlay arm(Approach::Any);

  arm.move_to(10.0);
  const double from_below = arm.move_to(45.0);
  arm.move_to(80.0);
  const double from_above = arm.move_to(45.0);

  EXPECT_NEAR(std::abs(from_above - from_below), kPlay_deg, 1e-3);
}

TEST(Backlash, WithAnApproachSideThePlaceIsTheSameFromWhereverItCame) {
  for (const Approach side : {Approach::FromBelow, Approach::FromAbove}) {
    ArmWithPlay arm(side);
    arm.move_to(10.0);
    const double place = arm.move_to(45.0);

    for (const double from : {80.0, 44.9, 45.1, 45.0, 46.0, 20.0, 44.5}) {
      arm.move_to(from);
      EXPECT_NEAR(arm.move_to(45.0), place, 2e-4) << "from " << from;  // a count is 1e-4 deg
    }
  }
}

}  // namespace
}  // namespace gonio::daemon
