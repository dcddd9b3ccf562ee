#include "drivers/modbus_stage/modbus_halt_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/drivers/scripted_modbus_link.h"

namespace gonio::drivers {
namespace {

using namespace std::chrono_literals;
using test::ScriptedModbusLink;
using testing::ElementsAre;
using testing::HasSubstr;
using Next = ScriptedModbusLink::Next;

constexpr std::uint16_t kHeartbeatTimeout = 14;
constexpr std::uint16_t kHaltBlock = 160;
constexpr std::uint16_t kHeartbeat = 208;

class ModbusHaltLineTest : public testing::Test {
 protected:
  ScriptedModbusLink link;
  stage::RegisterMap map = stage::own_register_map();
  ModbusHaltLine line{link, map};
};

TEST_F(ModbusHaltLineTest, HaltsWithEpochAndKeyInOneWrite) {
  ASSERT_TRUE(line.halt(0x00020003));

  EXPECT_THAT(link.writes_to(kHaltBlock), ElementsAre(ElementsAre(2, 3, 0x5A5A)));
}

TEST_F(ModbusHaltLineTest, HaltsAgainOnAConnectionThatHadBroken) {
  link.script = {Next::Break, Next::LoseReply};

  EXPECT_TRUE(line.halt(1).has_value());
}

TEST_F(ModbusHaltLineTest, SaysSoWhenTheHaltCouldNotBeDelivered) {
  link.script.assign(10, Next::Break);

  const auto halted = line.halt(9);

  ASSERT_FALSE(halted.has_value());
  EXPECT_EQ(halted.error().code, ErrorCode::Unreachable);
  EXPECT_THAT(halted.error().tried, HasSubstr("halt with epoch 9"));
  EXPECT_EQ(link.transactions, ModbusHaltLine::kHaltTries);
}

TEST_F(ModbusHaltLineTest, ArmsTheWatchInMilliseconds) {
  ASSERT_TRUE(line.watch_heartbeat(1500ms));

  EXPECT_THAT(link.writes_to(kHeartbeatTimeout), ElementsAre(ElementsAre(1500)));
}

TEST_F(ModbusHaltLineTest, ArmsTheLongestWatchThatTheRegisterHolds) {
  ASSERT_TRUE(line.watch_heartbeat(100s));

  EXPECT_THAT(link.writes_to(kHeartbeatTimeout), ElementsAre(ElementsAre(65535)));
}

TEST_F(ModbusHaltLineTest, BeatsOnceACall) {
  link.script = {Next::LoseRequest};

  EXPECT_FALSE(line.beat().has_value());
  EXPECT_TRUE(line.beat().has_value());
  EXPECT_EQ(link.writes_to(kHeartbeat).size(), 1U);
}

TEST_F(ModbusHaltLineTest, PassesAnInterruptOn) {
  line.interrupt();

  EXPECT_EQ(link.interrupts, 1);
}

}  // namespace
}  // namespace gonio::drivers
