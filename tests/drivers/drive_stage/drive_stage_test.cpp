// The driver against simulated drives in manual time. What moves is judged by the simulator's own positions.
#include <gtest/gtest.h>

#include "tests/drivers/drive_stage/drive_bench.h"

namespace gonio::drivers::test {
namespace {

using namespace std::chrono_literals;
using Next = InProcessUnitLink::Next;

constexpr std::uint16_t kControl = 6914;  // of the shipped map

TEST(DriveStage, ReadsDrivesAndCouplerAsOneStage) {
  DriveBench bench;

  const StageState state = bench.look();

  EXPECT_FALSE(state.homed || state.moving || state.halted || state.heartbeat_tripped || state.interlock_open);
  EXPECT_EQ(state.fault, 0);
  EXPECT_EQ(state.source_shutter, stage::ShutterState::Closed);
  EXPECT_NEAR(state.monitor, 1.0, 1e-6);
  EXPECT_NEAR(state.lamp_temperature_c, 45.0, 0.05);
  EXPECT_NEAR(state.room_temperature_c, 22.0, 0.05);
  EXPECT_NEAR(state.humidity_percent, 40.0, 0.05);
  EXPECT_EQ(state.at, bench.clock.now());
}

TEST(DriveStage, WritesLimitsAndSpeedsToTheDrivesAtTheFirstLookAndReadsThemBack) {
  DriveBench bench;

  (void)bench.look();

  // theta_r: 0 to 85 deg at 1e-4 deg a count, 20 deg/s, 40 deg/s2 in steps of 0.1: as pairs of words, high one first.
  using Words = std::vector<std::uint16_t>;
  std::map<std::uint16_t, Words> written;
  for (const auto& write : bench.motion.of(Axis::ThetaR).writes) written[write.first] = write.words;
  EXPECT_EQ(written[1544], (Words{0x000C, 0xF850}));
  EXPECT_EQ(written[1546], (Words{0, 0}));
  EXPECT_EQ(written[6942], (Words{0x0003, 0x0D40}));
  EXPECT_EQ(written[1556], (Words{0, 400}));
  EXPECT_EQ(written[1558], (Words{0, 400}));
}

TEST(DriveStage, HomesAndMovesThereAndSaysSoByTheEncoders) {
  DriveBench bench;
  ASSERT_TRUE(bench.home());
  MotionTarget target = bench.to(Axis::ThetaI, 30.0);
  target[stage::index_of(Axis::PhiR)] = -120.0;
  target[stage::index_of(Axis::Carriage)] = 120.0;

  const auto moved = bench.move(target);

  ASSERT_TRUE(moved) << describe(moved.error());
  EXPECT_NEAR(bench.position(Axis::ThetaI), 30.0, 1e-4);
  EXPECT_NEAR(bench.position(Axis::PhiR), -120.0, 1e-4);
  EXPECT_NEAR(bench.position(Axis::Carriage), 120.0, 1e-3);
  EXPECT_NEAR(bench.look().axes[stage::index_of(Axis::PhiR)].position, -120.0, 1e-4);
}

TEST(DriveStage, MovesAsFastAsTheConfigurationSays) {
  sim::Scene scene = DriveBench::scene_with_drives();
  scene.stage.axes[stage::index_of(Axis::ThetaR)].settle_s = 0.0;
  DriveBench bench(scene);
  ASSERT_TRUE(bench.home());
  bench.config.axes[stage::index_of(Axis::ThetaR)].speed = 5.0;
  bench.config.axes[stage::index_of(Axis::ThetaR)].acceleration = 10.0;
  DriveStage slow({.axes = {nullptr, &bench.motion.of(Axis::ThetaR)}}, bench.config, bench.latch, bench.clock);
  ASSERT_TRUE(slow.read_state());
  const Instant began = bench.clock.now();

  ASSERT_TRUE(slow.start_move(DriveBench::to(Axis::ThetaR, 20.0), 0));
  while (bench.is_moving()) bench.wait(1ms);

  // A trapezoid: 20 deg / 5 deg/s + 5 / 10 s.
  EXPECT_NEAR(in_seconds(bench.clock.now() - began), 4.5, 0.002);
}

TEST(DriveStage, RefusesWhatLiesOutsideOfTheLimitsAndSendsNothing) {
  DriveBench bench;
  (void)bench.look();
  const auto writes = bench.motion.of(Axis::ThetaI).writes.size();

  const auto refused = bench.driver.start_move(DriveBench::to(Axis::ThetaI, 85.1), 0);

  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::OutOfLimits);
  EXPECT_EQ(bench.motion.of(Axis::ThetaI).writes.size(), writes);
}

TEST(DriveStage, RefusesToMoveBeforeHoming) {
  DriveBench bench;

  const auto moved = bench.move(DriveBench::to(Axis::ThetaI, 10.0));

  ASSERT_FALSE(moved.has_value());
  EXPECT_EQ(moved.error().code, ErrorCode::NotHomed);
  EXPECT_FALSE(bench.is_moving());
}

TEST(DriveStage, HaltsAllAxesAndMovesNothingUntilAReset) {
  DriveBench bench;
  ASSERT_TRUE(bench.home());
  MotionTarget target = bench.to(Axis::ThetaI, 60.0);
  target[stage::index_of(Axis::PhiR)] = 180.0;
  ASSERT_TRUE(bench.driver.start_move(target, 0));
  bench.wait(500ms);
  ASSERT_TRUE(bench.is_moving());

  const auto halted = bench.line.halt(1);
  bench.wait(2s);

  ASSERT_TRUE(halted) << describe(halted.error());
  EXPECT_FALSE(bench.is_moving());
  EXPECT_LT(bench.position(Axis::ThetaI), 30.0);
  const StageState state = bench.look();
  EXPECT_TRUE(state.halted);
  EXPECT_TRUE(state.homed) << "home is kept";
  EXPECT_EQ(state.epoch, 1U);
  EXPECT_EQ(bench.move(target, 1).error().code, ErrorCode::Stopped);
  EXPECT_FALSE(bench.is_moving());
  ASSERT_TRUE(bench.driver.reset(1));
  EXPECT_FALSE(bench.look().halted);
  EXPECT_FALSE(bench.is_moving()) << "a reset moves nothing";
  EXPECT_TRUE(bench.move(target, 1));
  EXPECT_NEAR(bench.position(Axis::PhiR), 180.0, 1e-4);
}

TEST(DriveStage, RefusesAnOlderEpochByItselfForMovesAndResets) {
  DriveBench bench;
  ASSERT_TRUE(bench.home());
  ASSERT_TRUE(bench.line.halt(7));
  const auto old_reset = bench.driver.reset(6);
  ASSERT_TRUE(bench.driver.reset(7));

  const auto old = bench.move(DriveBench::to(Axis::ThetaI, 10.0), 6);

  ASSERT_FALSE(old_reset.has_value());
  EXPECT_EQ(old_reset.error().code, ErrorCode::DeviceRefused);
  ASSERT_FALSE(old.has_value());
  EXPECT_EQ(old.error().code, ErrorCode::StaleEpoch);
  EXPECT_FALSE(bench.is_moving());
  EXPECT_TRUE(bench.move(DriveBench::to(Axis::ThetaI, 10.0), 7));
}

TEST(DriveStage, StopsWhatAHaltHasOvertaken) {
  DriveBench bench;
  ASSERT_TRUE(bench.home());
  (void)bench.look();
  // The halt's words arrive just before the word that starts the axis: the quick stop comes first, the start second.
  bool has_halted = false;
  bench.motion.of(Axis::ThetaR).before_write = [&](const InProcessUnitLink::Write& write) {
    if (write.first != kControl || write.words[1] != 0x1F || has_halted) return;
    has_halted = true;
    EXPECT_TRUE(bench.line.halt(1));
  };
  MotionTarget target = bench.to(Axis::ThetaR, 60.0);
  target[stage::index_of(Axis::PhiR)] = 100.0;

  const auto token = bench.driver.start_move(target, 0);

  ASSERT_TRUE(has_halted);
  ASSERT_TRUE(token) << describe(token.error());
  bench.wait(1s);
  EXPECT_FALSE(bench.is_moving());
  const StageState state = bench.look();
  EXPECT_TRUE(state.halted);
  EXPECT_EQ(state.refused_token, *token);
  EXPECT_NE(state.accepted_token, *token);
}

TEST(DriveStage, StillKnowsOfAHaltInANewProgram) {
  DriveBench bench;
  ASSERT_TRUE(bench.home());
  ASSERT_TRUE(bench.driver.start_move(DriveBench::to(Axis::ThetaI, 60.0), 0));
  ASSERT_TRUE(bench.line.halt(1));
  DriveLatch fresh;
  DriveStage next({.axes = {&bench.motion.of(Axis::ThetaI)}}, bench.config, fresh, bench.clock);

  const auto seen = next.read_state();

  ASSERT_TRUE(seen) << describe(seen.error());
  EXPECT_TRUE(seen->halted) << "the drive is in quick stop";
}

TEST(DriveStage, SeesThatADriveHasLostItsPower) {
  DriveBench bench;
  ASSERT_TRUE(bench.home());
  const StageState before = bench.look();

  bench.truth([](sim::StageModel& stage, Instant now) { stage.power_cycle_axis(Axis::PhiI, now); });
  const StageState after = bench.look();

  EXPECT_EQ(after.boot_counter, before.boot_counter + 1);
  EXPECT_FALSE(after.homed);
  EXPECT_FALSE(after.axes[stage::index_of(Axis::PhiI)].homed);
  EXPECT_TRUE(after.axes[stage::index_of(Axis::PhiR)].homed);
  EXPECT_EQ(bench.look().boot_counter, after.boot_counter) << "counted once";
  EXPECT_EQ(bench.motion.of(Axis::PhiI).writes.back().first, 6942) << "and set up anew";
}

TEST(DriveStage, FailsAMoveWhenADriveLosesItsPowerInIt) {
  DriveBench bench;
  ASSERT_TRUE(bench.home());
  const StageState before = bench.look();
  const auto token = bench.driver.start_move(DriveBench::to(Axis::ThetaI, 60.0), 0);
  ASSERT_TRUE(token);
  bench.wait(300ms);

  bench.truth([](sim::StageModel& stage, Instant now) { stage.power_cycle_axis(Axis::ThetaI, now); });
  const auto moved =
      bench.play(MoveTask(bench.config, before, DriveBench::to(Axis::ThetaI, 60.0), *token, 0, before.at));

  ASSERT_FALSE(moved.has_value());
  EXPECT_EQ(moved.error().code, ErrorCode::PositionLost);
}

TEST(DriveStage, ShowsAFaultWithTheDrivesOwnAlarmAndClearsItWhenItsCauseIsGone) {
  DriveBench bench;
  ASSERT_TRUE(bench.home());
  bench.truth([](sim::StageModel& stage, Instant now) { stage.block_axis(Axis::ThetaR, now); });

  const auto moved = bench.move(DriveBench::to(Axis::ThetaR, 40.0));
  const StageState faulty = bench.look();
  bench.truth([](sim::StageModel& stage, Instant) { stage.free_axis(Axis::ThetaR); });
  const auto reset = bench.driver.reset(0);

  ASSERT_FALSE(moved.has_value());
  EXPECT_EQ(moved.error().code, ErrorCode::DeviceFault);
  EXPECT_NE(moved.error().seen.find("theta_r"), std::string::npos);
  EXPECT_NE(moved.error().seen.find("0x8611"), std::string::npos) << moved.error().seen;
  EXPECT_EQ(faulty.axes[stage::index_of(Axis::ThetaR)].fault, 1) << "following error";
  ASSERT_TRUE(reset) << describe(reset.error());
  EXPECT_EQ(bench.look().fault, 0);
  EXPECT_TRUE(bench.move(DriveBench::to(Axis::ThetaR, 40.0)));
}

TEST(DriveStage, SaysAWordAgainWhoseReplyWasLostWithoutMovingTwice) {
  DriveBench bench;
  ASSERT_TRUE(bench.home());
  (void)bench.look();
  const auto before = bench.truth([](sim::StageModel& stage, Instant) { return stage.motion_commands(); });
  bench.motion.of(Axis::ThetaI).before_write = [&](const InProcessUnitLink::Write& write) {
    const bool is_first = write.first == kControl && write.words[1] == 0x1F &&
                          bench.motion.of(Axis::ThetaI).script.empty() && bench.motion.of(Axis::ThetaI).resyncs == 0;
    if (is_first) bench.motion.of(Axis::ThetaI).script = {Next::LoseReply};
  };
  bench.motion.of(Axis::ThetaI).script = {Next::LoseReply};

  const auto moved = bench.move(DriveBench::to(Axis::ThetaI, 10.0));

  ASSERT_TRUE(moved) << describe(moved.error());
  EXPECT_GE(bench.motion.of(Axis::ThetaI).resyncs, 1) << "the line is emptied after each";
  EXPECT_EQ(bench.truth([](sim::StageModel& stage, Instant) { return stage.motion_commands(); }), before + 1);
}

TEST(DriveStage, AsksAgainForAPositionThatTheAxisCannotHaveReached) {
  DriveBench bench;
  ASSERT_TRUE(bench.home());
  const StageState before = bench.look();
  InProcessUnitLink& link = bench.motion.of(Axis::ThetaI);
  // A look reads the status, then the position: the second reply is somebody else's.
  link.script = {Next::Obey, Next::OtherReply};

  const StageState after = bench.look();

  EXPECT_EQ(after.axes[0].counts, before.axes[0].counts);
}

TEST(DriveStage, ReportsADriveThatIsGoneByItsName) {
  DriveBench bench;
  (void)bench.look();
  bench.motion.of(Axis::PhiI).is_dead = true;

  const auto seen = bench.driver.read_state();
  bench.clock.advance(3s);
  const auto later = bench.driver.read_state();

  ASSERT_FALSE(seen.has_value());
  EXPECT_EQ(seen.error().code, ErrorCode::TimedOut);
  EXPECT_NE(seen.error().tried.find("phi_i"), std::string::npos);
  ASSERT_FALSE(later.has_value());
  EXPECT_EQ(later.error().code, ErrorCode::Unreachable) << "silent for longer than the heartbeat's timeout";
}

TEST(DriveStage, OpensAndClosesShuttersAndSeesTheInterlock) {
  DriveBench bench;
  (void)bench.look();

  ASSERT_TRUE(bench.driver.set_shutters(true, false));
  bench.wait(2s);
  const StageState open = bench.look();
  bench.truth([](sim::StageModel& stage, Instant now) { stage.set_interlock(true, now); });
  const StageState interlock = bench.look();

  EXPECT_EQ(open.source_shutter, stage::ShutterState::Open);
  EXPECT_EQ(open.detector_shutter, stage::ShutterState::Closed);
  EXPECT_TRUE(interlock.interlock_open);
  EXPECT_EQ(bench.move(DriveBench::to(Axis::ThetaI, 10.0)).error().code, ErrorCode::Interlock);
}

TEST(DriveStage, KeepsAnAxisWithoutADriveWhereItStands) {
  DriveBench bench;
  bench.config.drives->axes[stage::index_of(Axis::PhiI)] = {.fixed = 12.0};
  DriveStage stage({.axes = {&bench.motion.of(Axis::ThetaI)}}, bench.config, bench.latch, bench.clock);
  (void)stage.read_state();

  const auto stays = stage.start_move(DriveBench::to(Axis::PhiI, 12.0), 0);
  const auto goes = stage.start_move(DriveBench::to(Axis::PhiI, 13.0), 0);
  const auto seen = stage.read_state();

  EXPECT_TRUE(stays);
  ASSERT_FALSE(goes.has_value());
  EXPECT_EQ(goes.error().code, ErrorCode::OutOfLimits);
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->axes[stage::index_of(Axis::PhiI)].position, 12.0);
  EXPECT_TRUE(seen->axes[stage::index_of(Axis::PhiI)].homed);
}

TEST(DriveHaltLine, PassesADeadDriveOverAndStopsTheOthers) {
  DriveBench bench;
  ASSERT_TRUE(bench.home());
  MotionTarget target = bench.to(Axis::ThetaI, 60.0);
  target[stage::index_of(Axis::ThetaR)] = 60.0;
  ASSERT_TRUE(bench.driver.start_move(target, 0));
  bench.wait(500ms);
  bench.halts.of(Axis::ThetaI).is_dead = true;

  const auto halted = bench.line.halt(1);
  bench.wait(1s);

  ASSERT_FALSE(halted.has_value());
  EXPECT_EQ(halted.error().code, ErrorCode::TimedOut);
  EXPECT_EQ(bench.halts.of(Axis::ThetaI).transactions, DriveHaltLine::kHaltTries);
  EXPECT_FALSE(bench.truth([](sim::StageModel& s, Instant now) { return s.axis(Axis::ThetaR).is_moving(now); }));
  EXPECT_TRUE(bench.truth([](sim::StageModel& s, Instant now) { return s.axis(Axis::ThetaI).is_moving(now); }));
  EXPECT_TRUE(bench.look().halted);
}

TEST(DriveHaltLine, ArmsTheWatchdogOfEachDriveAndOnlyReadsItFromThenOn) {
  DriveBench bench;

  ASSERT_TRUE(bench.line.watch_heartbeat(2s));
  ASSERT_TRUE(bench.line.beat());
  ASSERT_TRUE(bench.line.beat());

  ASSERT_EQ(bench.beats.of(Axis::ThetaR).writes.size(), 1U);
  EXPECT_EQ(bench.beats.of(Axis::ThetaR).writes[0].first, 5644);
  EXPECT_EQ(bench.beats.of(Axis::ThetaR).writes[0].words, (std::vector<std::uint16_t>{0, 2000}));
}

TEST(DriveHaltLine, LeavesItToTheDrivesToStopWhenNobodySpeaksToThem) {
  DriveBench bench;
  ASSERT_TRUE(bench.home());
  ASSERT_TRUE(bench.line.watch_heartbeat(2s));
  ASSERT_TRUE(bench.line.beat());
  ASSERT_TRUE(bench.driver.start_move(DriveBench::to(Axis::PhiR, 300.0), 0));
  bench.feeds = false;

  bench.wait(5s);

  EXPECT_FALSE(bench.is_moving());
  EXPECT_LT(bench.position(Axis::PhiR), 120.0) << "2 s at 40 deg/s, and the braking";
  const StageState tripped = bench.look();
  EXPECT_TRUE(tripped.heartbeat_tripped);
  EXPECT_TRUE(tripped.homed);
  EXPECT_EQ(tripped.fault, 0) << "a trip is no fault of the drive";
  ASSERT_TRUE(bench.driver.reset(0));
  EXPECT_FALSE(bench.look().heartbeat_tripped);
  bench.feeds = true;
  EXPECT_TRUE(bench.move(DriveBench::to(Axis::PhiR, 10.0)));
}

TEST(DriveHaltLine, ArmsAWatchdogAnewThatAPowerLossHasForgotten) {
  DriveBench bench;
  ASSERT_TRUE(bench.line.watch_heartbeat(2s));
  ASSERT_TRUE(bench.line.beat());
  bench.truth([](sim::StageModel& stage, Instant now) { stage.power_cycle_axis(Axis::ThetaR, now); });

  ASSERT_TRUE(bench.line.beat());

  EXPECT_EQ(bench.beats.of(Axis::ThetaR).writes.size(), 2U);
  EXPECT_EQ(bench.beats.of(Axis::ThetaI).writes.size(), 1U);
}

TEST(DriveHaltLine, FeedsTheOthersWhenOneDoesNotAnswer) {
  DriveBench bench;
  ASSERT_TRUE(bench.line.watch_heartbeat(2s));
  bench.beats.of(Axis::ThetaI).is_dead = true;

  const auto fed = bench.line.beat();

  ASSERT_FALSE(fed.has_value());
  EXPECT_EQ(bench.beats.of(Axis::FilterWheel).writes.size(), 1U);
}

TEST(DriveHaltLine, GivesABeatUpWhenItIsInterrupted) {
  DriveBench bench;
  ASSERT_TRUE(bench.line.watch_heartbeat(2s));
  bench.beats.of(Axis::ThetaR).before_write = [&](const InProcessUnitLink::Write&) { bench.line.interrupt(); };

  const auto cut = bench.line.beat();
  bench.beats.of(Axis::ThetaR).before_write = [](const InProcessUnitLink::Write&) {};
  const auto next = bench.line.beat();

  ASSERT_FALSE(cut.has_value());
  EXPECT_EQ(cut.error().code, ErrorCode::Unreachable);
  EXPECT_TRUE(next) << "only the beat that was in progress";
}

}  // namespace
}  // namespace gonio::drivers::test
