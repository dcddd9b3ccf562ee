#include "sim/devices/stage_face.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/sim/bench.h"

namespace gonio::sim::test {
namespace {

using stage::Refusal;
using stage::StatusBit;

TEST(StageFace, EchoesTheTokenInTheBlockThatItReads) {
  Bench bench;
  const stage::Block block = bench.map().status_block();
  std::vector<std::uint16_t> words(block.count);

  bench.write(Field::Token, 0xBEEF);
  const auto refused = bench.face.read(block.first, words, bench.now);

  EXPECT_FALSE(refused);
  EXPECT_EQ(stage::decode(words, block.first, bench.map().at(Field::Token)), 0xBEEF);
  EXPECT_EQ(stage::decode(words, block.first, bench.map().at(Field::Identity)), stage::kIdentity);
}

TEST(StageFace, RefusesRegistersThatAreNotThere) {
  Bench bench;
  std::vector<std::uint16_t> words(2);

  EXPECT_EQ(bench.face.read(0xFFF0, words, bench.now), ModbusException::IllegalAddress);
  EXPECT_EQ(bench.face.write(0xFFF0, words, bench.now), ModbusException::IllegalAddress);
}

TEST(StageFace, RefusesWritesToWhatItOnlyReports) {
  Bench bench;

  bench.write(Field::StopCount, 7);

  EXPECT_EQ(bench.last_write, ModbusException::IllegalAddress);
  EXPECT_EQ(bench.value(Field::StopCount), 0);
}

TEST(StageFace, RefusesToMoveBeforeHoming) {
  Bench bench;

  bench.move(Axis::ThetaR, 10.0);

  EXPECT_EQ(bench.value(Field::RefusedToken), bench.token);
  EXPECT_EQ(bench.refusal(), Refusal::NotHomed);
  EXPECT_FALSE(bench.has(StatusBit::Moving));
}

TEST(StageFace, IsHomedOnceEveryAxisHasFoundItsZero) {
  InstrumentMemory memory;
  memory.stage.positions = stage::PerAxis<double>{30.0, 40.0, 90.0, 0.0, 120.0, 2.0};
  Bench bench(quiet_scene(), memory);

  bench.command(stage::kCommandHome, 0);
  EXPECT_TRUE(bench.has(StatusBit::Moving));
  EXPECT_FALSE(bench.has(StatusBit::Homed));
  bench.wait(60.0);

  EXPECT_TRUE(bench.has(StatusBit::Homed));
  EXPECT_EQ(bench.position(Axis::Carriage), 0.0);
  EXPECT_EQ(bench.position(Axis::FilterWheel), 1.0);  // its low limit: there is no slot 0
}

TEST(StageFace, CountsFromWhereItWasSwitchedOnUntilItIsHomed) {
  InstrumentMemory memory;
  memory.stage.positions = stage::PerAxis<double>{30.0, 40.0, 90.0, 0.0, 120.0, 2.0};
  Bench bench(quiet_scene(), memory);

  EXPECT_EQ(bench.position(Axis::ThetaI), 0.0);
  EXPECT_EQ(bench.instrument.stage().axis(Axis::ThetaI).position(bench.now), 30.0);
}

TEST(StageFace, FollowsTheTrapezoidOfItsAxis) {
  Bench bench;
  bench.home();

  bench.move(Axis::ThetaR, 60.0);
  bench.wait(0.5);  // the ramp: 5 deg
  EXPECT_NEAR(bench.position(Axis::ThetaR), 5.0, 1e-4);
  bench.wait(1.0);
  EXPECT_NEAR(bench.position(Axis::ThetaR), 25.0, 1e-4);
  EXPECT_TRUE(bench.has(StatusBit::Moving));
  bench.wait(2.0);

  EXPECT_EQ(bench.value(Field::AcceptedToken), bench.token);
  EXPECT_NEAR(bench.position(Axis::ThetaR), 60.0, 1e-9);
  EXPECT_FALSE(bench.has(StatusBit::Moving));
}

TEST(StageFace, RefusesATargetBeyondItsLimitAndMovesNothing) {
  Bench bench;
  bench.home();

  bench.move(Axis::ThetaR, 85.01);

  EXPECT_EQ(bench.refusal(), Refusal::BeyondLimit);
  EXPECT_FALSE(bench.has(StatusBit::Moving));
  bench.move(Axis::ThetaR, 85.0);
  EXPECT_EQ(bench.value(Field::AcceptedToken), bench.token);
}

TEST(StageFace, RefusesASecondMoveWhileItMoves) {
  Bench bench;
  bench.home();

  bench.move(Axis::ThetaR, 60.0);
  bench.move(Axis::ThetaI, 10.0);

  EXPECT_EQ(bench.refusal(), Refusal::AlreadyMoving);
}

TEST(StageFace, RefusesACommandThatItDoesNotKnow) {
  Bench bench;
  bench.home();

  bench.command(7, 0);

  EXPECT_EQ(bench.refusal(), Refusal::BadCommand);
}

TEST(StageFace, BrakesOnAHaltAndRefusesUntilReset) {
  Bench bench;
  bench.home();
  bench.move(Axis::ThetaR, 60.0);
  bench.wait(1.0);  // at 15 deg, 20 deg/s

  bench.halt(3);
  bench.wait(0.4);
  EXPECT_TRUE(bench.has(StatusBit::Moving)) << "20 deg/s at 40 deg/s2 takes half a second";
  bench.wait(0.2);

  EXPECT_FALSE(bench.has(StatusBit::Moving));
  EXPECT_NEAR(bench.position(Axis::ThetaR), 15.0 + 20.0 * 20.0 / (2.0 * 40.0), 1e-4);
  EXPECT_TRUE(bench.has(StatusBit::Halted));
  EXPECT_EQ(bench.value(Field::Epoch), 3);
  EXPECT_EQ(bench.value(Field::StopCount), 1);
  bench.move(Axis::ThetaR, 10.0, 3);
  EXPECT_EQ(bench.refusal(), Refusal::Halted);
  bench.reset(3);
  EXPECT_FALSE(bench.has(StatusBit::Halted));
  bench.move(Axis::ThetaR, 10.0, 3);
  EXPECT_EQ(bench.value(Field::AcceptedToken), bench.token);
}

TEST(StageFace, RefusesMotionOfAnOlderEpoch) {
  Bench bench;
  bench.home();
  bench.halt(5);
  bench.reset(5);

  bench.move(Axis::ThetaR, 10.0, 4);

  EXPECT_EQ(bench.refusal(), Refusal::EpochTooOld);
  EXPECT_FALSE(bench.has(StatusBit::Moving));
}

TEST(StageFace, RefusesAResetBelowItsEpoch) {
  Bench bench;
  bench.halt(5);

  bench.reset(4);

  EXPECT_EQ(bench.last_write, ModbusException::IllegalValue);
  EXPECT_TRUE(bench.has(StatusBit::Halted));
}

TEST(StageFace, KeepsItsEpochWhenAnOlderHaltComesAndStopsAllTheSame) {
  Bench bench;
  bench.home();
  bench.halt(5);
  bench.reset(5);
  bench.move(Axis::ThetaR, 60.0, 5);
  bench.wait(1.0);

  bench.halt(2);
  bench.wait(1.0);

  EXPECT_EQ(bench.value(Field::Epoch), 5);
  EXPECT_FALSE(bench.has(StatusBit::Moving));
  EXPECT_LT(bench.position(Axis::ThetaR), 30.0);
}

TEST(StageFace, TakesAHaltOnlyWithItsKey) {
  Bench bench;

  bench.keyed(bench.map().halt_block(), Field::HaltEpoch, 1, Field::HaltKey, 0x1234);

  EXPECT_EQ(bench.last_write, ModbusException::IllegalValue);
  EXPECT_FALSE(bench.has(StatusBit::Halted));
}

TEST(StageFace, StopsByItselfAtTheInstantWhenABeatIsMissed) {
  Bench bench;
  bench.home();
  bench.write(Field::HeartbeatTimeoutMs, 500);
  bench.move(Axis::ThetaR, 60.0);
  bench.wait(0.4);
  bench.write(Field::Heartbeat, 1);  // due again at 0.9 s

  bench.wait(30.0);  // looked at much later

  // At 0.9 s it stood at 5 + 0.4 * 20 deg; then 5 deg of braking.
  EXPECT_TRUE(bench.has(StatusBit::HeartbeatTripped));
  EXPECT_NEAR(bench.position(Axis::ThetaR), 18.0, 1e-4);
  EXPECT_TRUE(bench.has(StatusBit::Homed)) << "a trip keeps home";
  EXPECT_EQ(bench.value(Field::StopCount), 1);
  bench.move(Axis::ThetaR, 10.0);
  EXPECT_EQ(bench.refusal(), Refusal::HeartbeatTripped);
}

TEST(StageFace, WatchesAfreshAfterATripIsReset) {
  Bench bench;
  bench.home();
  bench.write(Field::HeartbeatTimeoutMs, 500);
  bench.wait(1.0);
  bench.reset(0);
  EXPECT_FALSE(bench.has(StatusBit::HeartbeatTripped));

  bench.wait(0.4);
  EXPECT_FALSE(bench.has(StatusBit::HeartbeatTripped));
  bench.wait(0.2);
  EXPECT_TRUE(bench.has(StatusBit::HeartbeatTripped));
}

TEST(StageFace, DoesNotTripWhileItIsFedOrNotWatched) {
  Bench bench;
  bench.wait(100.0);
  EXPECT_FALSE(bench.has(StatusBit::HeartbeatTripped));
  bench.write(Field::HeartbeatTimeoutMs, 500);

  for (std::uint16_t beat = 1; beat < 20; ++beat) {
    bench.wait(0.45);
    bench.write(Field::Heartbeat, beat);
  }

  EXPECT_FALSE(bench.has(StatusBit::HeartbeatTripped));
  EXPECT_EQ(bench.value(Field::HeartbeatSeen), 19);
}

TEST(StageFace, NoticesABlockedAxisAfterTheFollowingErrorTimeAndStopsAllOthers) {
  Bench bench;
  bench.home();
  bench.move(Axis::ThetaR, 60.0);
  bench.wait(1.0);

  bench.instrument.stage().block_axis(Axis::ThetaR, bench.now);
  bench.wait(0.4);
  EXPECT_EQ(bench.value(Field::Fault), 0);
  EXPECT_TRUE(bench.has(StatusBit::Moving)) << "the drive still tries";
  bench.wait(0.2);

  EXPECT_EQ(bench.value(Field::Fault), 1);
  EXPECT_TRUE(bench.has(StatusBit::Fault));
  EXPECT_NEAR(bench.position(Axis::ThetaR), 15.0, 1e-4);
  bench.move(Axis::ThetaI, 10.0);
  EXPECT_EQ(bench.refusal(), Refusal::Fault);
}

TEST(StageFace, ClearsAFaultOnlyWhenItsCauseIsGone) {
  Bench bench;
  bench.home();
  bench.instrument.stage().block_axis(Axis::ThetaR, bench.now);
  bench.move(Axis::ThetaR, 60.0);
  bench.wait(1.0);
  ASSERT_EQ(bench.value(Field::Fault), 1);

  bench.reset(0);
  EXPECT_EQ(bench.value(Field::Fault), 1);
  bench.instrument.stage().free_axis(Axis::ThetaR);
  bench.reset(0);

  EXPECT_EQ(bench.value(Field::Fault), 0);
  bench.move(Axis::ThetaR, 60.0);
  EXPECT_EQ(bench.value(Field::AcceptedToken), bench.token);
}

TEST(StageFace, StopsAndRefusesWithAnOpenInterlock) {
  Bench bench;
  bench.home();
  bench.move(Axis::ThetaR, 60.0);
  bench.wait(1.0);

  bench.instrument.stage().set_interlock(true, bench.now);
  bench.wait(1.0);

  EXPECT_NEAR(bench.position(Axis::ThetaR), 20.0, 1e-4);
  bench.move(Axis::ThetaR, 10.0);
  EXPECT_EQ(bench.refusal(), Refusal::InterlockOpen);
}

TEST(StageFace, GrowsItsBootCounterAndForgetsHomeAtEachPowerUp) {
  Bench bench;
  bench.home();
  EXPECT_EQ(bench.value(Field::BootCounter), 1);

  bench.instrument.power_cycle_stage(bench.now);

  EXPECT_EQ(bench.value(Field::BootCounter), 2);
  EXPECT_FALSE(bench.has(StatusBit::Homed));
  EXPECT_EQ(bench.value(Field::GateCount), 0);
}

TEST(StageFace, ShowsAShutterAsMovingForItsTravelTime) {
  Scene scene = quiet_scene();
  scene.stage.shutter_s = 0.1;
  Bench bench(scene);

  bench.open_shutters();

  EXPECT_EQ(bench.value(Field::SourceShutter), 2);
  bench.wait(0.1);
  EXPECT_EQ(bench.value(Field::SourceShutter), 1);
}

TEST(StageFace, RunsFasterByTheScaleOfTime) {
  Scene scene = quiet_scene();
  scene.time_scale = 40.0;
  Bench bench(scene);
  bench.home();

  bench.move(Axis::ThetaR, 60.0);
  bench.wait(3.5 / 40.0 - 1e-3);
  EXPECT_TRUE(bench.has(StatusBit::Moving));
  bench.wait(2e-3);

  EXPECT_FALSE(bench.has(StatusBit::Moving));
}

}  // namespace
}  // namespace gonio::sim::test
