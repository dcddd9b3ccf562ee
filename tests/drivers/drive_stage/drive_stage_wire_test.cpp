// The driver of drives and libmodbus against the simulator's wires: seven units over one connection, or on one line.
#include <gtest/gtest.h>

#include <unistd.h>

#include <functional>

#include "drivers/links/rtu_bus.h"
#include "drivers/links/tcp_modbus_link.h"
#include "sim/wires/modbus_server.h"
#include "sim/wires/rtu_server.h"
#include "tests/drivers/drive_stage/drive_bench.h"

namespace gonio::drivers::test {
namespace {

using namespace std::chrono_literals;

/// A way to each unit, made by `make`.
class Ways {
 public:
  using Make = std::function<std::unique_ptr<ModbusLink>(const ModbusUnit&)>;
  Ways(const stage::DriveStageMap& map, const Make& make) {
    for (const Axis axis : stage::kAllAxes) {
      const stage::DriveMap& drive = *map.map_of(axis);
      kept_.push_back(make({map.axis(axis).unit_id, drive.reads, drive.writes}));
      links_.axes[stage::index_of(axis)] = kept_.back().get();
    }
    kept_.push_back(make({map.io->unit_id, map.io->reads, map.io->writes}));
    links_.io = kept_.back().get();
  }
  [[nodiscard]] const DriveLinks& all() const { return links_; }

 private:
  std::vector<std::unique_ptr<ModbusLink>> kept_;
  DriveLinks links_;
};

class DriveStageWire : public testing::Test {
 protected:
  DriveStageWire() : scene(DriveBench::scene_with_drives()), instrument(scene, {}, clock) {
    config = DriveBench::config_of(scene);
    config.heartbeat_timeout = 60s;
  }

  void home_move_and_halt(DriveStage& stage, DriveHaltLine& line) {
    ASSERT_TRUE(line.watch_heartbeat(60s));
    const auto fed = line.beat();
    ASSERT_TRUE(fed) << describe(fed.error());
    const auto before = stage.read_state();
    ASSERT_TRUE(before) << describe(before.error());
    const auto homing = stage.start_homing(0);
    ASSERT_TRUE(homing) << describe(homing.error());
    Result<StageState> seen = stage.read_state();
    for (int looks = 0; looks < 10000 && seen && !seen->homed; ++looks) seen = stage.read_state();
    ASSERT_TRUE(seen) << describe(seen.error());
    ASSERT_TRUE(seen->homed);
    const auto token = stage.start_move(DriveBench::to(Axis::PhiR, 300.0), 0);
    ASSERT_TRUE(token) << describe(token.error());
    seen = stage.read_state();
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->accepted_token, *token);

    const Instant asked = clock.now();
    const auto halted = line.halt(1);
    RecordProperty("halt_us", static_cast<int>((clock.now() - asked) / 1us));

    ASSERT_TRUE(halted) << describe(halted.error());
    seen = stage.read_state();
    for (int looks = 0; looks < 10000 && seen && seen->moving; ++looks) seen = stage.read_state();
    ASSERT_TRUE(seen) << describe(seen.error());
    EXPECT_TRUE(seen->halted);
    EXPECT_LT(seen->axes[stage::index_of(Axis::PhiR)].position, 299.0);
    EXPECT_EQ(seen->boot_counter, before->boot_counter);
  }

  SystemClock clock;
  sim::Scene scene;
  StageConfig config;
  sim::LiveInstrument instrument;
  DriveLatch latch;
};

TEST_F(DriveStageWire, HomesMovesAndHaltsOverOneConnection) {
  auto server = sim::ModbusServer::start(instrument, "127.0.0.1", 0);
  ASSERT_TRUE(server) << describe(server.error());
  const TcpModbusConfig to{
      .address = "127.0.0.1", .port = (*server)->port(), .reply_timeout = 30s, .connect_timeout = 30s};
  TcpModbusLink motion(to);
  TcpModbusLink halt(to);
  const Ways ways(*config.drives, [&](const ModbusUnit& unit) { return motion.for_unit(unit); });
  const Ways halts(*config.drives, [&](const ModbusUnit& unit) { return halt.for_unit(unit); });
  DriveStage stage(ways.all(), config, latch, clock);
  DriveHaltLine line(halts.all(), halts.all(), config, latch, clock);

  home_move_and_halt(stage, line);
}

TEST_F(DriveStageWire, HomesMovesAndHaltsOnOneSerialLine) {
  const std::string link = testing::TempDir() + "drive_stage_" + std::to_string(::getpid()) + ".tty";
  auto server = sim::RtuServer::start(instrument, link, {.baud = 115200});
  ASSERT_TRUE(server) << describe(server.error());
  RtuBus bus({.line = {.device = link, .baud = 115200, .parity = Parity::None, .stop_bits = 2}, .reply_timeout = 30s});
  const auto of_rank = [&](RtuBus::Rank rank) {
    return [&bus, rank](const ModbusUnit& unit) { return bus.for_unit(rank, unit); };
  };
  const Ways ways(*config.drives, of_rank(RtuBus::Rank::Normal));
  const Ways halts(*config.drives, of_rank(RtuBus::Rank::Urgent));
  const Ways beats(*config.drives, of_rank(RtuBus::Rank::Prompt));
  DriveStage stage(ways.all(), config, latch, clock);
  DriveHaltLine line(halts.all(), beats.all(), config, latch, clock);

  home_move_and_halt(stage, line);
}

}  // namespace
}  // namespace gonio::drivers::test
