// The stage driver and libmodbus against the simulator's stage, over TCP.
#include <gtest/gtest.h>

#include "drivers/links/tcp_modbus_link.h"
#include "drivers/modbus_stage/modbus_halt_line.h"
#include "drivers/modbus_stage/modbus_stage.h"
#include "sim/scene/read_scene.h"
#include "sim/wires/modbus_server.h"
#include "tests/drivers/stage_states.h"

namespace gonio::drivers {
namespace {

using namespace std::chrono_literals;

sim::Scene scene() {
  auto read = sim::read_scene(GONIO_SCENE_DIR "/lambertian.toml");
  EXPECT_TRUE(read) << describe(read.error());
  return std::move(*read);
}

class ModbusStageWire : public testing::Test {
 protected:
  ModbusStageWire() {
    auto started = sim::ModbusServer::start(instrument, "127.0.0.1", 0);
    EXPECT_TRUE(started) << describe(started.error());
    server = std::move(*started);
  }

  TcpModbusConfig to(std::uint16_t port) const {
    return {.address = "127.0.0.1", .port = port, .unit_id = 1, .reply_timeout = 30s, .connect_timeout = 30s};
  }

  SystemClock clock;
  sim::LiveInstrument instrument{scene(), {}, clock};
  std::unique_ptr<sim::ModbusServer> server;
  StageConfig config = test::simple_config();
};

TEST_F(ModbusStageWire, ReadsAStateAndHomesAndHalts) {
  TcpModbusLink link(to(server->port()));
  TcpModbusLink other_link(to(server->port()));
  ModbusStage stage(link, config, clock);
  ModbusHaltLine line(other_link, config.registers);

  const auto before = stage.read_state();
  const auto token = stage.start_homing(1);
  const auto halted = line.halt(2);
  const auto after = stage.read_state();

  ASSERT_TRUE(before) << describe(before.error());
  ASSERT_TRUE(token) << describe(token.error());
  ASSERT_TRUE(halted) << describe(halted.error());
  ASSERT_TRUE(after) << describe(after.error());
  EXPECT_FALSE(before->homed || before->halted);
  EXPECT_EQ(after->accepted_token, *token);
  EXPECT_TRUE(after->halted);
  EXPECT_EQ(after->epoch, 2U);
  EXPECT_EQ(after->stop_count, before->stop_count + 1);
}

TEST_F(ModbusStageWire, ComesBackByItselfWhenTheStageRefusedConnectionsForAWhile) {
  TcpModbusLink link(to(server->port()));
  ModbusStage stage(link, config, clock);
  ASSERT_TRUE(stage.read_state());
  server->set_refusing(true);
  Result<StageState> gone = stage.read_state();
  for (int i = 0; i < 1000 && gone; ++i) gone = stage.read_state();  // the server's thread may not have begun yet
  server->set_refusing(false);

  Result<StageState> back = stage.read_state();
  for (int i = 0; i < 1000 && !back; ++i) back = stage.read_state();  // the server's thread may still be closing

  ASSERT_FALSE(gone.has_value());
  EXPECT_EQ(gone.error().code, ErrorCode::Unreachable);
  EXPECT_TRUE(back.has_value()) << describe(back.error());
}

TEST_F(ModbusStageWire, IsRefusedAResetBelowTheStagesEpoch) {
  TcpModbusLink link(to(server->port()));
  ModbusStage stage(link, config, clock);
  ModbusHaltLine line(link, config.registers);
  ASSERT_TRUE(line.halt(5));

  const auto reset = stage.reset(4);

  ASSERT_FALSE(reset.has_value());
  EXPECT_EQ(reset.error().code, ErrorCode::DeviceRefused);
  EXPECT_TRUE(stage.reset(5).has_value());
}

}  // namespace
}  // namespace gonio::drivers
