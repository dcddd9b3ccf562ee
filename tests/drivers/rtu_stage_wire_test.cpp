// The stage driver over a serial line, against the simulator's, with each fault that its wire knows.
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <future>
#include <optional>
#include <thread>

#include "drivers/links/rtu_bus.h"
#include "drivers/modbus_stage/modbus_halt_line.h"
#include "drivers/modbus_stage/modbus_stage.h"
#include "sim/scene/read_scene.h"
#include "sim/wires/rtu_server.h"
#include "tests/drivers/stage_states.h"

namespace gonio::drivers {
namespace {

using namespace std::chrono_literals;
using Kind = sim::FaultKind;

constexpr Duration kReplyTimeout = 250ms;
constexpr int kTries = 100;  // of what a slow machine may let time out

sim::Scene scene() {
  auto read = sim::read_scene(GONIO_SCENE_DIR "/lambertian.toml");
  EXPECT_TRUE(read) << describe(read.error());
  return std::move(*read);
}

class RtuStageWire : public testing::Test {
 protected:
  RtuStageWire() {
    auto started = sim::RtuServer::start(instrument, link, {.baud = 460800, .turnaround = 1ms});
    EXPECT_TRUE(started) << describe(started.error());
    server = std::move(*started);
    bus.emplace(RtuLineConfig{.line = {.device = link, .baud = 460800, .parity = Parity::None, .stop_bits = 2},
                              .reply_timeout = kReplyTimeout,
                              .pause = 5ms});
    stage.emplace(bus->normal(), config, clock);
    line.emplace(bus->urgent(), bus->prompt(), config.registers);
  }

  // Of the next request, whatever it is.
  void arm(sim::FaultKind kind, double late_wall_s = 0.0) {
    sim::PlannedFault fault{.kind = kind};
    fault.values[sim::FaultParameter::Exchange] = static_cast<double>(sim::ExchangeKind::Any);
    fault.values[sim::FaultParameter::LateWallS] = late_wall_s;
    instrument.with([&](sim::LiveInstrument::Parts& parts) { EXPECT_TRUE(parts.instrument.arm(fault, parts.now)); });
  }

  template <class Call>
  static auto until_it_works(Call call) {
    auto done = call();
    for (int i = 1; i < kTries && !done; ++i) done = call();
    EXPECT_TRUE(done) << describe(done.error());
    return done;
  }

  const std::string link = testing::TempDir() + "rtu-" + std::to_string(::getpid()) + ".tty";
  SystemClock clock;
  sim::LiveInstrument instrument{scene(), {}, clock};
  std::unique_ptr<sim::RtuServer> server;
  StageConfig config = test::simple_config();
  std::optional<RtuBus> bus;
  std::optional<ModbusStage> stage;
  std::optional<ModbusHaltLine> line;
};

TEST_F(RtuStageWire, ReadsAStateAndHomesAndHaltsAndBeats) {
  const auto before = until_it_works([&] { return stage->read_state(); });
  const auto token = until_it_works([&] { return stage->start_homing(1); });
  until_it_works([&] { return line->watch_heartbeat(30s); });
  until_it_works([&] { return line->beat(); });
  until_it_works([&] { return line->halt(2); });
  const auto after = until_it_works([&] { return stage->read_state(); });

  EXPECT_FALSE(before->homed || before->halted);
  EXPECT_EQ(after->accepted_token, *token);
  EXPECT_TRUE(after->halted);
  EXPECT_EQ(after->epoch, 2U);
}

struct NamedFault {
  const char* name;
  sim::FaultKind kind;
  double late_wall_s = 0.0;
};

class RtuStageWireFault : public RtuStageWire, public testing::WithParamInterface<NamedFault> {};

TEST_P(RtuStageWireFault, IsRetriedAndNoMotionStartsTwice) {
  until_it_works([&] { return stage->read_state(); });
  until_it_works([&] { return stage->reset(1); });
  const auto motions = [&] {
    return instrument.with(
        [](sim::LiveInstrument::Parts& parts) { return parts.instrument.stage().motion_commands(); });
  };
  arm(GetParam().kind, GetParam().late_wall_s);

  const auto state = until_it_works([&] { return stage->read_state(); });
  arm(GetParam().kind, GetParam().late_wall_s);
  const auto token = stage->start_homing(1);

  EXPECT_EQ(state->boot_counter, 1U);
  ASSERT_TRUE(token.has_value()) << describe(token.error());
  const auto after = until_it_works([&] { return stage->read_state(); });
  EXPECT_EQ(after->accepted_token, *token);
  EXPECT_EQ(motions(), 1U);
}

INSTANTIATE_TEST_SUITE_P(OfReplies, RtuStageWireFault,
                         testing::Values(NamedFault{"Lost", Kind::ReplyLost},
                                         NamedFault{"LateByHalfATimeout", Kind::ReplyLate, 0.375},
                                         NamedFault{"LateBeyondTwoTimeouts", Kind::ReplyLate, 0.625},
                                         NamedFault{"LateByThreeTimeouts", Kind::ReplyLate, 1.000},
                                         NamedFault{"Torn", Kind::ReplyTorn}, NamedFault{"BadCrc", Kind::ReplyBadCrc},
                                         NamedFault{"WrongUnit", Kind::ReplyWrongUnit}),
                         [](const auto& fault) { return std::string(fault.param.name); });

TEST_F(RtuStageWire, StopsAStageThatAnswersNobody) {
  until_it_works([&] { return stage->read_state(); });
  arm(Kind::ReplyLost);
  std::atomic<bool> is_over{false};
  auto looking = std::async(std::launch::async, [&] {
    while (!is_over) (void)stage->read_state();
  });

  until_it_works([&] { return line->halt(9); });

  is_over = true;
  looking.get();
  instrument.with([](sim::LiveInstrument::Parts& parts) {
    EXPECT_TRUE(parts.instrument.stage().is_halted());
    EXPECT_EQ(parts.instrument.stage().epoch(), 9U);
  });
}

TEST_F(RtuStageWire, ComesBackByItselfWhenTheAdapterWasPulledOutForAWhile) {
  until_it_works([&] { return stage->read_state(); });
  server->set_refusing(true);
  Result<StageState> gone = stage->read_state();
  for (int i = 0; i < kTries && gone; ++i) gone = stage->read_state();  // the server's thread may not have begun yet
  server->set_refusing(false);
  while (!std::filesystem::exists(link)) std::this_thread::yield();  // the server's thread makes it

  const auto back = until_it_works([&] { return stage->read_state(); });

  ASSERT_FALSE(gone.has_value());
  EXPECT_EQ(gone.error().code, ErrorCode::Unreachable) << describe(gone.error());
  EXPECT_EQ(back->boot_counter, 1U);
}

}  // namespace
}  // namespace gonio::drivers
