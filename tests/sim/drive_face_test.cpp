// Simulated drives and coupler, byte by byte: frames as Modbus Messaging on TCP/IP V1.0b writes them, words of the
// state machine as CiA 402-2 prints them (table of the status word: x is any).
#include "sim/devices/drive_face.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/devices/drive_units.h"
#include "sim/scene/drive_stage.h"
#include "sim/wires/modbus_reply.h"
#include "tests/sim/bench.h"
#include "tests/sim/hex_bytes.h"

namespace gonio::sim::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

Scene scene_with_drives() {
  Scene scene = quiet_scene();
  scene.stage.drives = drive_stage_of(scene.stage);
  return scene;
}

class DriveFaceTest : public testing::Test {
 protected:
  DriveFaceTest() : instrument(scene_with_drives(), {}, kPowerUp), units(instrument), reply(*ModbusReply::make()) {}

  Bytes ask(const std::string& hex) { return reply.answer(bytes(hex), units, now); }
  // Of the drive of theta_r, unit 2.
  std::uint16_t status() {
    const Bytes answer = ask("00 01 00 00 00 06 02 03 1b 04 00 02");
    return answer.size() == 13 ? static_cast<std::uint16_t>(answer[11] << 8U | answer[12]) : 0;
  }
  void control(const std::string& low_byte) {
    (void)ask("00 01 00 00 00 0b 02 10 1b 02 00 02 04 00 00 00 " + low_byte);
  }
  void enable() {
    for (const char* word : {"06", "07", "0f"}) control(word);
  }

  Instrument instrument;
  DriveUnits units;
  ModbusReply reply;
  Instant now = kPowerUp;
};

TEST_F(DriveFaceTest, AnswersAReadOfItsStatusAsTheStandardsWriteIt) {
  // Switch on disabled, voltage enabled, remote, target reached, motion ended: 4650h in two registers.
  EXPECT_EQ(ask("00 07 00 00 00 06 02 03 1b 04 00 02"), bytes("00 07 00 00 00 07 02 03 04 00 00 46 50"));
}

TEST_F(DriveFaceTest, EchoesAWriteOfItsControlWord) {
  EXPECT_EQ(ask("00 08 00 00 00 0b 02 10 1b 02 00 02 04 00 00 00 06"), bytes("00 08 00 00 00 06 02 10 1b 02 00 02"));
}

TEST_F(DriveFaceTest, RefusesWhatItDoesNotHave) {
  EXPECT_EQ(ask("00 01 00 00 00 06 02 03 00 00 00 01"), bytes("00 01 00 00 00 03 02 83 02")) << "no such register";
  EXPECT_EQ(ask("00 01 00 00 00 06 02 06 1b 04 00 01"), bytes("00 01 00 00 00 03 02 86 02")) << "read only";
  EXPECT_EQ(ask("00 01 00 00 00 06 02 04 1b 04 00 01"), bytes("00 01 00 00 00 03 02 84 01")) << "no input registers";
  EXPECT_EQ(ask("00 01 00 00 00 06 09 03 1b 04 00 02"), bytes("00 01 00 00 00 03 09 83 0b")) << "no such unit";
}

TEST_F(DriveFaceTest, GoesThroughTheStatesInTheirOrder) {
  EXPECT_EQ(status() & 0x4F, 0x40) << "switch on disabled";
  control("0f");
  EXPECT_EQ(status() & 0x4F, 0x40) << "no way to operation from there";
  control("06");
  EXPECT_EQ(status() & 0x6F, 0x21) << "ready to switch on";
  control("07");
  EXPECT_EQ(status() & 0x6F, 0x23) << "switched on";
  control("0f");
  EXPECT_EQ(status() & 0x6F, 0x27) << "operation enabled";
  control("02");
  EXPECT_EQ(status() & 0x6F, 0x07) << "quick stop active";
  control("06");
  EXPECT_EQ(status() & 0x6F, 0x07) << "which it stays in";
  control("0f");
  EXPECT_EQ(status() & 0x6F, 0x27);
  control("00");
  EXPECT_EQ(status() & 0x4F, 0x40);
}

TEST_F(DriveFaceTest, HomesOnTheEdgeOfItsStartBitInHomingMode) {
  enable();
  (void)ask("00 01 00 00 00 0b 02 10 1b 06 00 02 04 00 00 00 06");
  EXPECT_EQ(status() & 0x8000, 0);

  control("1f");

  EXPECT_EQ(status() & 0x8000, 0x8000) << "it stood at its home";
}

TEST_F(DriveFaceTest, FallsIntoFaultOutsideOfItsSoftLimits) {
  enable();
  (void)ask("00 01 00 00 00 0b 02 10 06 08 00 02 04 00 00 03 e8");  // high limit 1000
  (void)ask("00 01 00 00 00 0b 02 10 1b 1c 00 02 04 00 00 03 e9");  // target 1001
  control("0f");

  control("1f");

  EXPECT_EQ(status() & 0x4F, 0x08);
  EXPECT_FALSE(instrument.stage().is_moving(now));
  control("00");
  control("80");
  EXPECT_EQ(status() & 0x4F, 0x40);
}

TEST_F(DriveFaceTest, StopsByItsWatchdogAtTheInstantItIsDue) {
  enable();
  (void)ask("00 01 00 00 00 0b 02 10 16 0c 00 02 04 00 00 03 e8");  // 1000 ms
  (void)ask("00 01 00 00 00 0b 02 10 1b 1e 00 02 04 00 03 0d 40");  // 20 deg/s
  (void)ask("00 01 00 00 00 0b 02 10 06 14 00 02 04 00 00 01 90");  // 40 deg/s2
  (void)ask("00 01 00 00 00 0b 02 10 1b 1c 00 02 04 00 0c 35 00");  // 80 deg
  control("1f");

  now += std::chrono::seconds(10);
  const std::uint16_t seen = status();

  EXPECT_EQ(seen & 0x4F, 0x08);
  // 0.5 s to 20 deg/s (5 deg), 0.5 s at it (10 deg), 0.5 s to rest (5 deg).
  EXPECT_NEAR(instrument.stage().axis(stage::Axis::ThetaR).position(now), 20.0, 1e-6);
  EXPECT_EQ(ask("00 01 00 00 00 06 02 03 1c 0a 00 02"), bytes("00 01 00 00 00 07 02 03 04 00 00 81 30")) << "alarm";
}

TEST_F(DriveFaceTest, ShowsInputsAndTakesOutputsAsTheCouplersMapHasThem) {
  // Source shutter output on: function 6 to 0800h of unit 20.
  EXPECT_EQ(ask("00 01 00 00 00 06 14 06 08 00 00 01"), bytes("00 01 00 00 00 06 14 06 08 00 00 01"));
  now += std::chrono::seconds(5);

  const Bytes inputs = ask("00 01 00 00 00 06 14 03 00 00 00 07");

  // Monitor 1.0 in steps of 1e-7, 45.0, 25.0, 22.0 deg C and 40.0 % in tenths; bits: source open, detector closed.
  EXPECT_EQ(inputs, bytes("00 01 00 00 00 11 14 03 0e 00 98 96 80 01 c2 00 fa 00 dc 01 90 00 09"));
  EXPECT_EQ(instrument.stage().source_shutter().state(now), stage::ShutterState::Open);
}

}  // namespace
}  // namespace gonio::sim::test
