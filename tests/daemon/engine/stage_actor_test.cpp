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
  std::optional<Instant> arrives_at;
  std::vector<std::string> told;
  std::vector<drivers::Epoch> epochs;
  int looks = 0;

 private:
  void arrive() {
    for (std::size_t i = 0; i < stage::kAxisCount; ++i) {
      if (target_[i]) state.axes[i].position = *target_[i];
    }
    state.moving = false;
    state.homed = true;
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

TEST_F(StageActorTest, NoticesAPowerCycleWhileItWatchesTheGate) {
  ask(LookAtStage{1});
  ask(WatchGate{.ticket = 2, .after = 0, .expected = 200ms, .held = {}});
  executor.run_for(100ms);

  stage.state.boot_counter = 2;
  run_for_answers(2);

  ASSERT_FALSE(answers[1].state.has_value());
  EXPECT_EQ(answers[1].state.error().code, ErrorCode::PositionLost);
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
