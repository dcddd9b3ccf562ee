// STOP as bytes on a socket, against a stage that acknowledges halts and nothing else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

#include "daemon/engine/halt_path.h"
#include "drivers/links/tcp_modbus_link.h"
#include "drivers/modbus_stage/modbus_halt_line.h"
#include "tests/drivers/scripted_modbus_server.h"

namespace gonio::daemon {
namespace {

using namespace std::chrono_literals;
using drivers::test::Bytes;
using drivers::test::bytes;
using drivers::test::ScriptedModbusServer;

constexpr std::uint8_t kWriteSeveral = 0x10;

TEST(HaltPathOnTheWire, SendsTheHaltWhileABeatWaitsForAReplyThatNeverComes) {
  ScriptedModbusServer stage([](const Bytes& request, int) {
    if (request[7] != kWriteSeveral) return ScriptedModbusServer::Answer{};
    return ScriptedModbusServer::Answer{drivers::test::reply_to(request, bytes("10 00 a0 00 03"))};
  });
  drivers::TcpModbusLink link(
      {.address = "127.0.0.1", .port = stage.port(), .unit_id = 1, .reply_timeout = 1h, .connect_timeout = 1min});
  const stage::RegisterMap map = stage::own_register_map();
  drivers::ModbusHaltLine line(link, map);
  const SystemClock clock;
  std::promise<HaltReport> halted;
  HaltPath path(line, clock, {.heartbeat_timeout = 1h}, [&](const HaltPathReport& report) {
    if (const auto* halt = std::get_if<HaltReport>(&report)) halted.set_value(*halt);
  });
  stage.wait_for_requests(1);  // the watch is being armed, and is not answered

  path.stop("operator");

  const HaltReport report = halted.get_future().get();  // an hour early
  EXPECT_TRUE(report.outcome.has_value());
  Bytes frame = stage.requests().back();
  frame.erase(frame.begin(), frame.begin() + 2);
  // FC16 at 160: epoch 1 in two registers, then the key 5a5a
  EXPECT_EQ(frame, bytes("00 00 00 0d 01 10 00 a0 00 03 06 00 00 00 01 5a 5a"));
}

}  // namespace
}  // namespace gonio::daemon
