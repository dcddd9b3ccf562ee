// A look at the stage, one FC23 that writes a token and reads the status block: our driver on its link, and libmodbus
// bare.
#include <fmt/format.h>
#include <modbus/modbus.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <memory>
#include <vector>

#include "bench/wires/bench_scene.h"
#include "bench/wires/contest.h"
#include "bench/wires/contests.h"
#include "drivers/links/rtu_bus.h"
#include "drivers/links/tcp_modbus_link.h"
#include "drivers/modbus_stage/modbus_stage.h"
#include "sim/wires/modbus_server.h"
#include "sim/wires/rtu_server.h"

namespace gonio::bench {
namespace {

using namespace std::chrono_literals;

constexpr Duration kReplyTimeout = 1s;
const SystemClock clock_of_the_bench;

drivers::StageConfig config_of(const stage::RegisterMap& registers) {
  drivers::StageConfig config;
  config.registers = registers;
  config.heartbeat_timeout = 2s;
  return config;
}

double our_rate(drivers::ModbusLink& link, int exchanges) {
  const drivers::StageConfig config = config_of(stage::own_register_map());
  drivers::ModbusStage stage(link, config, clock_of_the_bench);
  return per_second(exchanges, [&] { return stage.read_state().has_value(); });
}

using Context = std::unique_ptr<modbus_t, void (*)(modbus_t*)>;

double bare_rate(const Context& context, int exchanges) {
  const stage::RegisterMap map = stage::own_register_map();
  const stage::Block block = map.status_block();
  modbus_set_slave(context.get(), map.unit_id);
  modbus_set_response_timeout(context.get(), 1, 0);
  if (modbus_connect(context.get()) != 0) return 0.0;
  std::vector<std::uint16_t> words(block.count);
  std::uint16_t token = 0;
  const double rate = per_second(exchanges, [&] {
    ++token;
    return modbus_write_and_read_registers(context.get(), map.at(stage::Field::Token).address, 1, &token, block.first,
                                           block.count, words.data()) == block.count;
  });
  modbus_close(context.get());
  return rate;
}

// A line in the folder of temporary files, gone with it.
class Line {
 public:
  Line() : link_(std::filesystem::temp_directory_path() / fmt::format("bench-wires-{}.tty", ::getpid())) {}
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;
  ~Line() {
    std::error_code ignored;
    std::filesystem::remove(link_, ignored);
  }
  [[nodiscard]] std::string path() const { return link_.string(); }

 private:
  std::filesystem::path link_;
};

struct Speed {
  int baud;             // that both masters believe
  sim::RtuTiming line;  // that the slave keeps
  int exchanges;        // of a stretch
  std::string name;
};

bool hold_line(sim::LiveInstrument& instrument, const Speed& speed, int rounds) {
  const Line line;
  const auto server = sim::RtuServer::start(instrument, line.path(), speed.line);
  if (!server) return false;
  // No silence between frames: libmodbus keeps none either.
  const drivers::RtuLineConfig config{
      .line = {.device = line.path(), .baud = speed.baud, .parity = drivers::Parity::None, .stop_bits = 2},
      .reply_timeout = kReplyTimeout,
      .silence = Duration::zero()};
  return hold({.what = speed.name,
               .ours =
                   [&] {
                     drivers::RtuBus bus(config);
                     return our_rate(bus.normal(), speed.exchanges);
                   },
               .bare =
                   [&] {
                     const Context context(modbus_new_rtu(line.path().c_str(), speed.baud, 'N', 8, 2), modbus_free);
                     return bare_rate(context, speed.exchanges);
                   }},
              rounds);
}

}  // namespace

bool hold_stage_over_tcp(int rounds) {
  constexpr int kExchanges = 3000;
  sim::LiveInstrument instrument(bench_scene(), {}, clock_of_the_bench);
  const auto server = sim::ModbusServer::start(instrument, "127.0.0.1", 0);
  if (!server) return false;
  const std::uint16_t port = (*server)->port();
  return hold({.what = "stage, Modbus TCP, one look (FC23)",
               .ours =
                   [&] {
                     drivers::TcpModbusLink link({.address = "127.0.0.1",
                                                  .port = port,
                                                  .reply_timeout = kReplyTimeout,
                                                  .connect_timeout = kReplyTimeout});
                     return our_rate(link, kExchanges);
                   },
               .bare =
                   [&] {
                     const Context context(modbus_new_tcp("127.0.0.1", port), modbus_free);
                     return bare_rate(context, kExchanges);
                   }},
              rounds);
}

bool hold_stage_over_rtu(int rounds) {
  sim::LiveInstrument instrument(bench_scene(), {}, clock_of_the_bench);
  const std::array speeds{
      Speed{115200, {.baud = 115200}, 25, "stage, Modbus RTU at 115200 baud, one look (FC23)"},
      // A pseudo terminal has no speed: a slave that answers at once leaves nothing but the masters' own time.
      Speed{921600,
            {.baud = 1'000'000'000, .turnaround = Duration::zero()},
            1500,
            "stage, Modbus RTU, a line without speed"}};
  bool all = true;
  for (const Speed& speed : speeds) all = hold_line(instrument, speed, rounds) && all;
  return all;
}

}  // namespace gonio::bench
