// Register numbers are those of protocol/stage/README.md, counted by hand.
#include "drivers/modbus_stage/modbus_stage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/drivers/scripted_modbus_link.h"
#include "tests/drivers/stage_states.h"

namespace gonio::drivers {
namespace {

using stage::Axis;
using test::ScriptedModbusLink;
using testing::ElementsAre;
using testing::HasSubstr;
using Next = ScriptedModbusLink::Next;

constexpr std::uint16_t kMotionBlock = 128;
constexpr std::uint16_t kResetBlock = 176;
constexpr std::uint16_t kShutterBlock = 192;
constexpr std::size_t kAcceptedToken = 10;
constexpr std::size_t kRefusedToken = 11;

class ModbusStageTest : public testing::Test {
 protected:
  ModbusStageTest() {
    link.registers[1] = 0x474F;
    link.registers[2] = 1;
  }

  static MotionTarget theta_r_to(double position) {
    MotionTarget target;
    target[stage::index_of(Axis::ThetaR)] = position;
    return target;
  }

  ScriptedModbusLink link;
  StageConfig config = test::simple_config();
  ManualClock clock;
  ModbusStage stage{link, config, clock};
};

TEST_F(ModbusStageTest, ReadsTheWholeStateInOneTransaction) {
  const auto state = stage.read_state();

  ASSERT_TRUE(state) << describe(state.error());
  EXPECT_EQ(link.transactions, 1);
  EXPECT_EQ(state->at, clock.now());
}

TEST_F(ModbusStageTest, UnderstandsTheWordsOfTheStatusBlock) {
  auto& r = link.registers;
  r[3] = 0x0001, r[4] = 0x0002;     // boot counter 65538
  r[5] = 0b000111;                  // moving, homed, halted
  r[7] = 0, r[8] = 42;              // epoch
  r[9] = 6;                         // stop count
  r[12] = 5;                        // refusal: beyond a limit
  r[15] = 1, r[16] = 2;             // source open, detector moving
  r[17] = 0x0098, r[18] = 0x9680;   // monitor 10 000 000 x 1e-7
  r[21] = 0xFFFF;                   // room -0.01 degC
  r[22] = 4550;                     // 45.5 %
  r[23] = 0, r[24] = 9, r[25] = 1;  // gate: 9 exposures, one open
  r[40] = 0xFFFF, r[41] = 0xFF9C;   // theta_r: -100 counts
  r[42] = 0b0110;                   // homed, at the low limit
  r[43] = 3;                        // limit switch
  r[44] = 0, r[45] = 7;             // gate open encoder
  r[46] = 0, r[47] = 8;             // gate close encoder

  const auto state = stage.read_state();

  ASSERT_TRUE(state) << describe(state.error());
  EXPECT_EQ(state->boot_counter, 65538U);
  EXPECT_TRUE(state->moving && state->homed && state->halted);
  EXPECT_FALSE(state->heartbeat_tripped || state->interlock_open);
  EXPECT_EQ(state->epoch, 42U);
  EXPECT_EQ(state->stop_count, 6);
  EXPECT_EQ(state->refusal, stage::Refusal::BeyondLimit);
  EXPECT_EQ(state->source_shutter, stage::ShutterState::Open);
  EXPECT_EQ(state->detector_shutter, stage::ShutterState::Moving);
  EXPECT_DOUBLE_EQ(state->monitor, 1.0);
  EXPECT_DOUBLE_EQ(state->room_temperature_c, -0.01);
  EXPECT_DOUBLE_EQ(state->humidity_percent, 45.5);
  EXPECT_EQ(state->gate.count, 9U);
  EXPECT_TRUE(state->gate.open);
  const AxisState& theta_r = state->axes[stage::index_of(Axis::ThetaR)];
  EXPECT_EQ(theta_r.counts, -100);
  EXPECT_DOUBLE_EQ(theta_r.position, -0.01);
  EXPECT_TRUE(theta_r.homed && theta_r.at_limit);
  EXPECT_FALSE(theta_r.moving);
  EXPECT_EQ(theta_r.fault, 3);
  EXPECT_EQ(state->gate.open_counts[1], 7);
  EXPECT_EQ(state->gate.close_counts[1], 8);
}

TEST_F(ModbusStageTest, WritesANewTokenWithEveryLook) {
  ASSERT_TRUE(stage.read_state());
  ASSERT_TRUE(stage.read_state());

  EXPECT_THAT(link.writes_to(0), ElementsAre(ElementsAre(1), ElementsAre(2)));
}

TEST_F(ModbusStageTest, ThrowsAStaleReplyAwayAndAsksAgain) {
  ASSERT_TRUE(stage.read_state());
  link.registers[9] = 77;  // the stale reply does not have this yet
  link.script = {Next::StaleReply};

  const auto state = stage.read_state();

  ASSERT_TRUE(state) << describe(state.error());
  EXPECT_EQ(state->stop_count, 77);
  EXPECT_EQ(link.resyncs, 1);
}

TEST_F(ModbusStageTest, GivesUpAfterABoundedNumberOfStaleReplies) {
  ASSERT_TRUE(stage.read_state());
  link.script.assign(10, Next::StaleReply);

  const auto state = stage.read_state();

  ASSERT_FALSE(state.has_value());
  EXPECT_EQ(state.error().code, ErrorCode::BadReply);
  EXPECT_THAT(state.error().seen, HasSubstr("token"));
  EXPECT_EQ(link.resyncs, ModbusStage::kTries);
}

TEST_F(ModbusStageTest, AsksAgainAfterALostReply) {
  link.script = {Next::LoseReply, Next::Break};

  EXPECT_TRUE(stage.read_state().has_value());
}

TEST_F(ModbusStageTest, SaysWhatWasTriedWhenTheStageStaysSilent) {
  link.script.assign(10, Next::LoseRequest);

  const auto state = stage.read_state();

  ASSERT_FALSE(state.has_value());
  EXPECT_EQ(state.error().code, ErrorCode::TimedOut);
  EXPECT_EQ(link.transactions, ModbusStage::kTries);
  EXPECT_THAT(describe(state.error()), HasSubstr("read its state"));
}

TEST_F(ModbusStageTest, IsUnreachableOnceSilentForTheHeartbeatsTimeout) {
  link.script.assign(ModbusStage::kTries + 1, Next::LoseRequest);
  ASSERT_EQ(stage.read_state().error().code, ErrorCode::TimedOut);
  clock.advance(config.heartbeat_timeout);

  const auto state = stage.read_state();

  ASSERT_FALSE(state.has_value());
  EXPECT_EQ(state.error().code, ErrorCode::Unreachable);
  EXPECT_THAT(state.error().limit, HasSubstr("heartbeat"));
  EXPECT_EQ(link.transactions, ModbusStage::kTries + 1) << "no more tries at a stage that has gone";
}

TEST_F(ModbusStageTest, CountsItsSilenceFromTheFirstExchangeWithoutAnAnswer) {
  ASSERT_TRUE(stage.read_state().has_value());
  clock.advance(10 * config.heartbeat_timeout);  // nobody asked: that is no silence
  link.script.assign(ModbusStage::kTries, Next::LoseRequest);
  ASSERT_EQ(stage.read_state().error().code, ErrorCode::TimedOut);
  ASSERT_TRUE(stage.read_state().has_value());  // it answered
  clock.advance(config.heartbeat_timeout);
  link.script.assign(ModbusStage::kTries, Next::LoseRequest);

  EXPECT_EQ(stage.read_state().error().code, ErrorCode::TimedOut);
}

TEST_F(ModbusStageTest, TakesAnExceptionAtItsWord) {
  link.script = {Next::Exception};

  const auto state = stage.read_state();

  ASSERT_FALSE(state.has_value());
  EXPECT_EQ(state.error().code, ErrorCode::DeviceRefused);
  EXPECT_EQ(link.transactions, 1);
}

TEST_F(ModbusStageTest, RefusesADeviceThatIsNotThisStage) {
  link.registers[1] = 0x1234;

  const auto state = stage.read_state();

  ASSERT_FALSE(state.has_value());
  EXPECT_EQ(state.error().code, ErrorCode::WrongDevice);
  EXPECT_THAT(state.error().seen, HasSubstr("identity 4660"));
}

TEST_F(ModbusStageTest, RefusesAStageWithAnotherMapVersion) {
  link.registers[2] = 2;

  const auto state = stage.read_state();

  ASSERT_FALSE(state.has_value());
  EXPECT_EQ(state.error().code, ErrorCode::WrongDevice);
}

TEST_F(ModbusStageTest, RefusesAWordThatNoStageSends) {
  link.registers[15] = 3;

  const auto state = stage.read_state();

  ASSERT_FALSE(state.has_value());
  EXPECT_EQ(state.error().code, ErrorCode::BadReply);
  EXPECT_THAT(state.error().seen, HasSubstr("source_shutter 3"));
}

TEST_F(ModbusStageTest, WritesAMoveAsOneBlockThatEndsWithTheCommand) {
  const auto token = stage.start_move(theta_r_to(45.0), 0x00010002);

  ASSERT_TRUE(token) << describe(token.error());
  // epoch, token, mask, six targets, command; 45 deg are 450 000 = 0x6DDD0 counts
  EXPECT_THAT(link.writes_to(kMotionBlock),
              ElementsAre(ElementsAre(1, 2, *token, 0b10, 0, 0, 6, 0xDDD0, 0, 0, 0, 0, 0, 0, 0, 0, 1)));
}

TEST_F(ModbusStageTest, AsksForAMoveOnALineWhereMovesAreCoordinated) {
  config.coordinated = true;

  const auto token = stage.start_move(theta_r_to(45.0), 0x00010002);

  ASSERT_TRUE(token) << describe(token.error());
  ASSERT_EQ(link.writes_to(kMotionBlock).size(), 1U);
  EXPECT_EQ(link.writes_to(kMotionBlock)[0].back(), 3);
}

TEST_F(ModbusStageTest, WritesHomingForAllAxes) {
  const auto token = stage.start_homing(3);

  ASSERT_TRUE(token) << describe(token.error());
  const auto written = link.writes_to(kMotionBlock);
  ASSERT_EQ(written.size(), 1U);
  EXPECT_EQ(written[0][3], 0b111111);
  EXPECT_EQ(written[0].back(), 2);
}

TEST_F(ModbusStageTest, SendsNothingForATargetBeyondALimit) {
  const auto token = stage.start_move(theta_r_to(97.2), 1);

  ASSERT_FALSE(token.has_value());
  EXPECT_EQ(token.error().code, ErrorCode::OutOfLimits);
  EXPECT_THAT(token.error().seen, HasSubstr("theta_r target 97.200 deg"));
  EXPECT_THAT(token.error().limit, HasSubstr("0.000 to 90.000 deg"));
  EXPECT_EQ(link.transactions, 0);
}

TEST_F(ModbusStageTest, SendsNothingForATargetThatIsNotANumber) {
  const auto token = stage.start_move(theta_r_to(std::nan("")), 1);

  ASSERT_FALSE(token.has_value());
  EXPECT_EQ(token.error().code, ErrorCode::OutOfLimits);
  EXPECT_EQ(link.transactions, 0);
}

TEST_F(ModbusStageTest, SendsNothingForATargetThatItsRegisterCannotHold) {
  config.axes[stage::index_of(Axis::ThetaR)].high = 1e9;

  const auto token = stage.start_move(theta_r_to(1e6), 1);  // 1e10 counts

  ASSERT_FALSE(token.has_value());
  EXPECT_EQ(token.error().code, ErrorCode::OutOfLimits);
  EXPECT_EQ(link.transactions, 0);
}

TEST_F(ModbusStageTest, NeverUsesATokenThatTheStageStillShowsFromAnEarlierRun) {
  link.registers[kAcceptedToken] = 1;
  link.registers[kRefusedToken] = 2;

  const auto token = stage.start_move(theta_r_to(1.0), 1);

  ASSERT_TRUE(token);
  EXPECT_EQ(*token, 3);
}

TEST_F(ModbusStageTest, DoesNotWriteAMoveTwiceWhenOnlyItsReplyWasLost) {
  link.on_write = [&](const ScriptedModbusLink::Write& write) {
    if (write.first == kMotionBlock) link.registers[kAcceptedToken] = write.words[2];
  };
  link.script = {Next::Obey, Next::LoseReply};

  const auto token = stage.start_move(theta_r_to(1.0), 1);

  ASSERT_TRUE(token) << describe(token.error());
  EXPECT_EQ(link.writes_to(kMotionBlock).size(), 1U);
}

TEST_F(ModbusStageTest, WritesAMoveAgainThatDidNotArrive) {
  link.script = {Next::Obey, Next::LoseRequest};

  const auto token = stage.start_move(theta_r_to(1.0), 1);

  ASSERT_TRUE(token) << describe(token.error());
  EXPECT_EQ(link.writes_to(kMotionBlock).size(), 1U);
}

TEST_F(ModbusStageTest, StartsAMoveAndLooksInOneExchange) {
  ASSERT_TRUE(stage.read_state());
  link.transactions = 0;
  link.on_write = [&](const ScriptedModbusLink::Write& write) {
    if (write.first == kMotionBlock) link.registers[kAcceptedToken] = write.words[2];
  };

  const auto started = stage.start_move_and_look(theta_r_to(45.0), 0x00010002);

  ASSERT_TRUE(started) << describe(started.error());
  EXPECT_EQ(link.transactions, 1);
  ASSERT_TRUE(started->seen);
  EXPECT_EQ(started->seen->accepted_token, started->token);
  EXPECT_THAT(link.writes_to(kMotionBlock),
              ElementsAre(ElementsAre(1, 2, started->token, 0b10, 0, 0, 6, 0xDDD0, 0, 0, 0, 0, 0, 0, 0, 0, 1)));
}

TEST_F(ModbusStageTest, DoesNotTakeALookBesideAMoveThatKnowsNothingOfIt) {
  const auto started = stage.start_move_and_look(theta_r_to(45.0), 1);

  ASSERT_TRUE(started) << describe(started.error());
  EXPECT_FALSE(started->seen) << "a stage that has not come to it, or a reply to something before";
}

TEST_F(ModbusStageTest, DoesNotStartAMoveTwiceWhenOnlyTheReplyToMoveAndLookWasLost) {
  link.on_write = [&](const ScriptedModbusLink::Write& write) {
    if (write.first == kMotionBlock) link.registers[kAcceptedToken] = write.words[2];
  };
  link.script = {Next::Obey, Next::LoseReply};

  const auto started = stage.start_move_and_look(theta_r_to(1.0), 1);

  ASSERT_TRUE(started) << describe(started.error());
  EXPECT_EQ(link.writes_to(kMotionBlock).size(), 1U);
}

TEST_F(ModbusStageTest, NamesTheMoveWhenTheStageRefusesTheWrite) {
  link.script = {Next::Obey, Next::Exception};

  const auto token = stage.start_move(theta_r_to(1.0), 1);

  ASSERT_FALSE(token.has_value());
  EXPECT_EQ(token.error().code, ErrorCode::DeviceRefused);
  EXPECT_THAT(token.error().tried, HasSubstr("move theta_r to 1.000 deg"));
}

TEST_F(ModbusStageTest, SetsBothShutters) {
  ASSERT_TRUE(stage.set_shutters(true, false));

  EXPECT_THAT(link.writes_to(kShutterBlock), ElementsAre(ElementsAre(1, 0)));
}

TEST_F(ModbusStageTest, ResetsWithEpochAndKey) {
  ASSERT_TRUE(stage.reset(7));

  EXPECT_THAT(link.writes_to(kResetBlock), ElementsAre(ElementsAre(0, 7, 0x4B4B)));
}

TEST_F(ModbusStageTest, RepeatsAResetWhoseReplyWasLost) {
  link.script = {Next::LoseReply};

  EXPECT_TRUE(stage.reset(7).has_value());
}

TEST_F(ModbusStageTest, TurnsCountsIntoPositionsByScaleAndOffset) {
  config.axes[0].offset = 1.5;
  config.registers.axis_scale[0] = -1e-3;

  EXPECT_DOUBLE_EQ(position_of(config, Axis::ThetaI, 500), 1.0);
  EXPECT_EQ(counts_of(config, Axis::ThetaI, 1.0), 500);
  EXPECT_EQ(counts_of(config, Axis::ThetaI, 1.0004), 500);  // to the nearest
}

}  // namespace
}  // namespace gonio::drivers
