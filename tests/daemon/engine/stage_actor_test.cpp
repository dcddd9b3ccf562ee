#include "daemon/engine/stage_actor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/discrete_executor.h"

namespace gonio::daemon {
namespace {

using namespace std::chrono_literals;
using stage::Axis;
using test::DiscreteExecutor;
using testing::HasSubstr;

/// A stage that is told how to behave; time comes from the test's clock.
class ScriptedStage final : public drivers::Stage {
 public:
  explicit ScriptedStage(const Clock& clock) : clock_(clock) {
    state.boot_counter = 1;
    state.homed = true;
    for (auto& axis : state.axes) axis.homed = true;
  }

  Result<drivers::StageState> read_state() override {
    ++looks;
    if (broken) return failure(*broken);
    if (arrives_at && clock_.now() >= *arrives_at) arrive();
    state.at = clock_.now();
    return state;
  }
  Result<drivers::MotionToken> start_move(const drivers::MotionTarget& target, drivers::Epoch epoch) override {
    told.push_back("move");
    targets.push_back(target);
    epochs.push_back(epoch);
    target_ = target;
    arrives_at = clock_.now() + travel;
    state.moving = true;
    return state.accepted_token = ++token_;
  }
  Result<drivers::MotionToken> start_homing(drivers::Epoch) override {
    told.push_back("home");
    arrives_at = clock_.now() + travel;
    state.homed = false;
    return state.accepted_token = ++token_;
  }
  Result<void> set_shutters(bool source_open, bool detector_open) override {
    told.push_back(std::string("shutters ") + (source_open ? "1" : "0") + (detector_open ? "1" : "0"));
    state.source_shutter = source_open ? stage::ShutterState::Open : stage::ShutterState::Closed;
    state.detector_shutter = detector_open ? stage::ShutterState::Open : stage::ShutterState::Closed;
    return {};
  }
  Result<void> reset(drivers::Epoch) override {
    told.push_back("reset");
    state.halted = false;
    return {};
  }

  drivers::StageState state;
  std::optional<Error> broken;
  Duration travel = 1s;
  bool stops_on_arrival = false;  ///< somebody stops the stage at the instant at which it arrives
  std::optional<Instant> arrives_at;
  std::vector<std::string> told;
  std::vector<drivers::Epoch> epochs;
  std::vector<drivers::MotionTarget> targets;
  int looks = 0;

 private:
  void arrive() {
    for (std::size_t i = 0; i < stage::kAxisCount; ++i) {
      if (target_[i]) state.axes[i].position = *target_[i];
    }
    state.moving = false;
    state.homed = true;
    if (stops_on_arrival) ++state.stop_count;
    arrives_at.reset();
  }

  const Clock& clock_;
  drivers::MotionTarget target_;
  drivers::MotionToken token_ = 0;
};

class StageActorTest : public testing::Test {
 protected:
  StageActorTest() {
    for (auto& axis : config.axes) {
      axis = {.low = 0.0, .high = 90.0, .speed = 10.0, .acceleration = 100.0, .settle = 100ms, .window = 0.01};
    }
    config.registers.axis_scale.fill(1e-4);
    config.homing_time = 30s;
    config.shutter_time = 2s;
    config.deadline_factor = 1.5;
    config.deadline_margin = 1s;
    executor.add("stage", [this](Instant now) { return actor.step(now); });
  }

  void ask(StageRequest request) {
    executor.post([this, request](Instant now) { actor.on(request, now); });
  }

  /// Until so many answers have come.
  void run_for_answers(std::size_t count) {
    ASSERT_EQ(executor.run_until([&] { return answers.size() >= count; }, 1h), DiscreteExecutor::Outcome::Reached)
        << executor.describe();
  }

  static MoveTo move(Ticket ticket, double theta_r) {
    MoveTo request{.ticket = ticket, .epoch = 4, .target = {}, .source_shutter_open = {}, .detector_shutter_open = {}};
    request.target[stage::index_of(Axis::ThetaR)] = theta_r;
    return request;
  }

  void keep_the_arms_apart() {
    const drivers::ArmHead head{millimetres(500.0), millimetres(700.0), millimetres(50.0)};
    config.keep_out.emplace(head, head, millimetres(0.0));
  }

  ManualClock clock;
  ScriptedStage stage{clock};
  drivers::StageConfig config;
  std::vector<StageAnswer> answers;
  StageActor actor{stage, config, [this](StageAnswer answer) { answers.push_back(std::move(answer)); }};
  DiscreteExecutor executor{clock};
};

TEST_F(StageActorTest, AnswersAMoveWhenItHasArrivedAndSettled) {
  const Instant start = clock.now();
  ask(move(11, 10.0));  // 10 at 10 per s and 100 per s^2: 1.1 s by the numbers, 1 s on this stage

  run_for_answers(1);

  EXPECT_EQ(answers[0].ticket, 11U);
  ASSERT_TRUE(answers[0].state) << describe(answers[0].state.error());
  EXPECT_DOUBLE_EQ(answers[0].state->axes[stage::index_of(Axis::ThetaR)].position, 10.0);
  EXPECT_GE(clock.now() - start, 1100ms);
  EXPECT_LE(clock.now() - start, 1200ms);
  EXPECT_EQ(stage.epochs, std::vector<drivers::Epoch>{4});
}

TEST_F(StageActorTest, LooksOnlyAFewTimesAtALongMove) {
  ask(move(11, 50.0));  // 5.1 s, one look each 250 ms and a few while it settles
  stage.travel = 5s;

  run_for_answers(1);

  EXPECT_LE(stage.looks, 30);
}

TEST_F(StageActorTest, ShuttersThatStandAsAskedAreNotToldAgain) {
  stage.state.source_shutter = stage::ShutterState::Open;
  MoveTo request = move(1, 10.0);
  request.source_shutter_open = true;
  request.detector_shutter_open = false;

  ask(request);
  run_for_answers(1);

  EXPECT_TRUE(std::ranges::none_of(stage.told, [](const auto& told) { return told.starts_with("shutters"); }));
  EXPECT_TRUE(answers[0].state.has_value());
}

TEST_F(StageActorTest, SetsTheShuttersThatWereNamedAndLeavesTheOther) {
  stage.state.detector_shutter = stage::ShutterState::Open;
  MoveTo request{.ticket = 1, .epoch = 0, .target = {}, .source_shutter_open = true, .detector_shutter_open = {}};

  ask(request);
  run_for_answers(1);

  EXPECT_EQ(stage.told, std::vector<std::string>{"shutters 11"});
  EXPECT_TRUE(answers[0].state.has_value());
}

TEST_F(StageActorTest, AnswersAMoveOfNothingWithTheState) {
  ask(MoveTo{.ticket = 5});

  run_for_answers(1);

  EXPECT_TRUE(answers[0].state.has_value());
  EXPECT_TRUE(stage.told.empty());
}

TEST_F(StageActorTest, TellsWhyAMoveFailed) {
  ask(move(3, 10.0));
  executor.run_for(500ms);

  stage.state.stop_count = 1;
  stage.state.halted = true;
  run_for_answers(1);

  ASSERT_FALSE(answers[0].state.has_value());
  EXPECT_EQ(answers[0].state.error().code, ErrorCode::Stopped);
}

TEST_F(StageActorTest, TellsAtOnceThatTheStageWasLostInAMove) {
  ask(move(3, 10.0));
  executor.run_for(500ms);

  stage.broken = Error{.code = ErrorCode::Unreachable, .device = "stage", .tried = "read", .seen = "no"};
  run_for_answers(1);

  ASSERT_FALSE(answers[0].state.has_value());
  EXPECT_EQ(answers[0].state.error().code, ErrorCode::Unreachable);
}

/// theta_r arrives from below, going past by 2 deg.
class StageActorApproachTest : public StageActorTest {
 protected:
  StageActorApproachTest() {
    config.axes[kThetaR].approach = drivers::Approach::FromBelow;
    config.axes[kThetaR].overrun = 2.0;
    stage.state.axes[kThetaR].position = 50.0;
  }

  [[nodiscard]] std::vector<double> stops() const {
    std::vector<double> at;
    for (const auto& target : stage.targets) at.push_back(target[kThetaR].value_or(-1.0));
    return at;
  }

  static constexpr std::size_t kThetaR = stage::index_of(Axis::ThetaR);
};

TEST_F(StageActorApproachTest, PlaysAMoveFromTheWrongSideAsTwoLegsOfOneEpoch) {
  const Instant start = clock.now();
  ask(move(1, 20.0));

  run_for_answers(1);

  ASSERT_TRUE(answers[0].state) << describe(answers[0].state.error());
  EXPECT_EQ(stops(), (std::vector{18.0, 20.0}));
  EXPECT_EQ(stage.epochs, (std::vector<drivers::Epoch>{4, 4}));
  EXPECT_DOUBLE_EQ(answers[0].state->axes[kThetaR].position, 20.0);
  EXPECT_GE(clock.now() - start, 2100ms);  // two travels of a second; only the last settles
  EXPECT_LE(clock.now() - start, 3700ms);  // by the numbers 3.3 s and 0.3 s: the looks come when they are due
}

TEST_F(StageActorApproachTest, GoesPastAfterHomingButNotAgainAfterAMoveThatEndedWell) {
  stage.state.axes[kThetaR].position = 20.0;
  ask(move(1, 20.0));
  ask(move(2, 20.0));
  ask(move(3, 30.0));
  run_for_answers(3);
  const auto before_homing = stops();
  ask(Home{4, 4});
  ask(move(5, 30.0));
  run_for_answers(5);

  EXPECT_EQ(before_homing, (std::vector{18.0, 20.0, 20.0, 30.0}));
  EXPECT_EQ(stops(), (std::vector{18.0, 20.0, 20.0, 30.0, 28.0, 30.0}));
}

TEST_F(StageActorApproachTest, StartsNoLegAfterAStop) {
  ask(move(1, 20.0));
  executor.run_for(100ms);

  // A STOP and its reset between two looks: only the count tells.
  stage.state.stop_count = 1;
  run_for_answers(1);

  ASSERT_FALSE(answers[0].state.has_value());
  EXPECT_EQ(answers[0].state.error().code, ErrorCode::Stopped);
  EXPECT_EQ(stops(), std::vector{18.0});
}

TEST_F(StageActorApproachTest, IsStoppedWhenTheStopFallsBetweenTwoLegs) {
  stage.stops_on_arrival = true;
  ask(move(1, 20.0));

  run_for_answers(1);

  ASSERT_FALSE(answers[0].state.has_value());
  EXPECT_EQ(answers[0].state.error().code, ErrorCode::Stopped);
  EXPECT_EQ(stops(), std::vector{18.0});
}

TEST_F(StageActorApproachTest, TakesTheSlackUpAgainAfterAMoveThatFailed) {
  ask(move(1, 20.0));
  executor.run_for(100ms);
  stage.state.stop_count = 1;
  run_for_answers(1);
  stage.arrives_at.reset();
  stage.state.moving = false;
  stage.state.axes[kThetaR].position = 19.5;

  ask(move(2, 20.0));
  run_for_answers(2);

  EXPECT_EQ(stops(), (std::vector{18.0, 18.0, 20.0}));
}

TEST_F(StageActorTest, DoesNotMoveArmsThatMayMeetBeforeTheyAreHomed) {
  keep_the_arms_apart();
  stage.state.axes[stage::index_of(Axis::PhiI)].homed = false;

  ask(move(1, 30.0));
  run_for_answers(1);

  ASSERT_FALSE(answers[0].state.has_value());
  EXPECT_EQ(answers[0].state.error().code, ErrorCode::NotHomed);
  EXPECT_TRUE(stage.told.empty());
}

TEST_F(StageActorTest, MovesNothingAtAllWhenTheWayIsBlocked) {
  keep_the_arms_apart();
  MoveTo into = move(1, 30.0);
  into.target[stage::index_of(Axis::ThetaI)] = 33.0;
  into.source_shutter_open = true;

  ask(into);
  run_for_answers(1);

  ASSERT_FALSE(answers[0].state.has_value());
  EXPECT_EQ(answers[0].state.error().code, ErrorCode::Blocked);
  EXPECT_TRUE(stage.told.empty());
}

TEST_F(StageActorTest, AnswersALookWhileAMoveIsUnderWay) {
  ask(move(1, 10.0));
  ask(LookAtStage{2});

  run_for_answers(2);

  EXPECT_EQ(answers[0].ticket, 2U);
  ASSERT_TRUE(answers[0].state);
  EXPECT_TRUE(answers[0].state->moving);
  EXPECT_EQ(answers[1].ticket, 1U);
}

TEST_F(StageActorTest, KeepsTheOrderOfEverythingElse) {
  ask(move(1, 10.0));
  ask(ResetStage{2, 4});
  ask(Home{3, 4});

  run_for_answers(3);

  EXPECT_EQ(answers[0].ticket, 1U);
  EXPECT_EQ(answers[1].ticket, 2U);
  EXPECT_EQ(answers[2].ticket, 3U);
  EXPECT_EQ(stage.told, (std::vector<std::string>{"move", "reset", "home"}));
}

TEST_F(StageActorTest, AnswersAResetWithTheStateAfterIt) {
  stage.state.halted = true;
  ask(ResetStage{9, 4});

  run_for_answers(1);

  ASSERT_TRUE(answers[0].state);
  EXPECT_FALSE(answers[0].state->halted);
}

TEST_F(StageActorTest, WatchesTheGate) {
  WatchGate watch{.ticket = 6, .after = 0, .expected = 200ms, .held = {}};
  ask(watch);
  executor.run_for(210ms);

  stage.state.gate.count = 1;
  run_for_answers(1);

  EXPECT_EQ(answers[0].ticket, 6U);
  ASSERT_TRUE(answers[0].state);
  EXPECT_EQ(answers[0].state->gate.count, 1U);
}

TEST_F(StageActorTest, BeginsAMoveByTheLookThatEndedTheExposureBeforeIt) {
  ask(WatchGate{.ticket = 1, .after = 0, .expected = 200ms, .held = {}});
  executor.run_for(100ms);
  stage.state.gate.count = 1;
  run_for_answers(1);
  const int looks = stage.looks;
  ask(move(2, 10.0));
  executor.run_for(1ms);
  EXPECT_EQ(stage.told, std::vector<std::string>{"move"});
  EXPECT_EQ(stage.looks - looks, 1) << "after it was told";

  run_for_answers(2);
  EXPECT_TRUE(answers[1].state);
}

TEST_F(StageActorTest, LooksAnewBeforeAMoveLongAfterTheExposure) {
  ask(WatchGate{.ticket = 1, .after = 0, .expected = 200ms, .held = {}});
  executor.run_for(100ms);
  stage.state.gate.count = 1;
  run_for_answers(1);
  executor.run_for(50ms);
  stage.state.axes[stage::index_of(Axis::ThetaR)].homed = false;
  const int looks = stage.looks;
  ask(move(2, 10.0));
  executor.run_for(1ms);

  EXPECT_EQ(stage.looks - looks, 2);
  run_for_answers(2);
  EXPECT_FALSE(answers[1].state);
}

TEST_F(StageActorTest, FindsAStopBetweenTheExposureAndTheMove) {
  ask(WatchGate{.ticket = 1, .after = 0, .expected = 200ms, .held = {}});
  executor.run_for(100ms);
  stage.state.gate.count = 1;
  run_for_answers(1);
  ++stage.state.stop_count;
  ask(move(2, 10.0));
  run_for_answers(2);

  ASSERT_FALSE(answers[1].state);
  EXPECT_EQ(answers[1].state.error().code, ErrorCode::Stopped);
}

TEST_F(StageActorTest, NoticesAPowerCycleWhileItWatchesTheGate) {
  ask(LookAtStage{1});
  ask(WatchGate{.ticket = 2, .after = 0, .expected = 200ms, .held = {}});
  executor.run_for(100ms);

  stage.state.boot_counter = 2;
  run_for_answers(2);

  ASSERT_FALSE(answers[1].state.has_value());
  EXPECT_EQ(answers[1].state.error().code, ErrorCode::PositionLost);
}

TEST_F(StageActorTest, RefusesToMoveByAnEncoderThatChangedByItselfUntilTheStageIsHomed) {
  ask(move(1, 10.0));
  run_for_answers(1);
  stage.state.axes[stage::index_of(Axis::ThetaI)].position += 1.0;
  ask(move(2, 20.0));
  ask(move(3, 20.0));
  run_for_answers(3);
  ask(Home{4});
  run_for_answers(4);
  ask(move(5, 20.0));
  run_for_answers(5);

  for (const std::size_t k : {1U, 2U}) {
    ASSERT_FALSE(answers[k].state.has_value());
    EXPECT_EQ(answers[k].state.error().code, ErrorCode::OutOfTolerance);
    EXPECT_THAT(describe(answers[k].state.error()), HasSubstr("theta_i shows 1.0000 deg and nothing has moved it"));
  }
  EXPECT_TRUE(answers[3].state && answers[4].state);
}

TEST_F(StageActorTest, SaysBusyToOneRequestTooMany) {
  ask(move(1, 10.0));
  for (Ticket ticket = 2; ticket <= 2 + StageActor::kMostWaiting; ++ticket) ask(ResetStage{ticket, 4});

  executor.run_for(10ms);

  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].ticket, 2 + StageActor::kMostWaiting);
  ASSERT_FALSE(answers[0].state.has_value());
  EXPECT_EQ(answers[0].state.error().code, ErrorCode::Busy);
}

TEST_F(StageActorTest, SleepsWhenThereIsNothingToDo) {
  EXPECT_FALSE(actor.step(clock.now()).has_value());
}

}  // namespace
}  // namespace gonio::daemon
