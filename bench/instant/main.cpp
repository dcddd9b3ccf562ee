// The engine with all its threads on a stage whose axes are there at once, over Modbus TCP, with a detector that
// answers at once and a store on the disk: items a second, each a move, an exposure and a durable commit. Beside it
// what the disk alone gives for such commits. Usage: bench_instant [FOLDER [POINTS]]   (a folder on the disk to be
// measured; the working folder, 5000 points)
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <string>
#include <vector>

#include "bench/instant/instant_stage.h"
#include "daemon/app/engine.h"
#include "daemon/app/log.h"
#include "drivers/links/tcp_modbus_link.h"
#include "drivers/modbus_stage/modbus_halt_line.h"
#include "drivers/modbus_stage/modbus_stage.h"
#include "tests/daemon/support/scan_records.h"

namespace {

using namespace gonio;
using SteadyClock = std::chrono::steady_clock;

constexpr double kLimit = 1500.0;
const SystemClock bench_clock;

double seconds_since(SteadyClock::time_point began) {
  return std::chrono::duration<double>(SteadyClock::now() - began).count();
}

// Its light is there as soon as it is asked for: 600 DN, in the dark 100 DN.
class InstantDetector final : public drivers::Detector {
 public:
  explicit InstantDetector(bench::InstantStage& stage) : stage_(stage) {}
  Result<drivers::DetectorIdentity> ensure_open() override { return drivers::DetectorIdentity{.vendor = "bench"}; }
  Result<void> apply(const drivers::ExposureSettings& settings) override {
    settings_ = settings;
    return {};
  }
  Result<void> trigger() override {
    stage_.count_gate();
    return {};
  }
  Result<std::optional<drivers::Frame>> collect(Duration /*wait*/) override {
    constexpr int kSide = 16;
    drivers::Frame frame{.width = kSide, .height = kSide, .significant_bits = 12};
    frame.pixels.assign(kSide * kSide, stage_.is_lit() ? 600 : 100);
    frame.frame_id = ++frame_id_;
    frame.settings = settings_;
    frame.arrived = bench_clock.now();
    return std::optional(std::move(frame));
  }

 private:
  bench::InstantStage& stage_;
  drivers::ExposureSettings settings_;
  std::uint64_t frame_id_ = 0;
};

daemon::Instrument instant_instrument() {
  daemon::Instrument instrument = daemon::test::bench_instrument();
  for (drivers::AxisConfig& axis : instrument.stage.axes) {
    axis.speed = 1e9;
    axis.acceleration = 1e15;
    axis.settle = Duration::zero();
  }
  instrument.stage.deadline_margin = std::chrono::seconds(1);
  instrument.stage.shutter_time = std::chrono::seconds(1);
  instrument.stage.homing_time = std::chrono::seconds(1);
  instrument.detector.shortest_exposure = std::chrono::microseconds(1);
  instrument.detector.longest_exposure = std::chrono::microseconds(1);
  instrument.detector.aperture = {.centre_x_px = 7.5, .centre_y_px = 7.5, .radius_px = 6.0};
  return instrument;
}

std::vector<double> steps(double from, double step, long count) {
  std::vector<double> values;
  for (long n = 0; n < count; ++n) values.push_back(from + step * static_cast<double>(n));
  return values;
}

double engine_rate(const std::string& store_file, long points) {
  bench::InstantStage stage;
  const daemon::Instrument instrument = instant_instrument();
  const drivers::TcpModbusConfig wire{.address = "127.0.0.1",
                                      .port = stage.port(),
                                      .unit_id = 1,
                                      .reply_timeout = std::chrono::seconds(1),
                                      .connect_timeout = std::chrono::seconds(1)};
  drivers::TcpModbusLink link(wire);
  drivers::TcpModbusLink halt_link(wire);
  drivers::ModbusStage driver(link, instrument.stage, bench_clock);
  drivers::ModbusHaltLine halt_line(halt_link, instrument.stage.registers);
  InstantDetector detector(stage);
  auto writer = daemon::StoreWriter::open({.path = store_file, .boot_id = "bench", .version = "bench"}, bench_clock);
  if (!writer) throw std::runtime_error(describe(writer.error()));

  std::atomic<long> accepted = 0;
  std::promise<void> over;
  SteadyClock::time_point began;
  daemon::Engine engine({.instrument = instrument, .store_file = store_file},
                        {.stage = driver, .halt_line = halt_line, .camera = &detector}, **writer, bench_clock,
                        [&](const daemon::EventRecord& event) {
                          if (event.kind == "scan-running") began = SteadyClock::now();
                          if (event.kind == "hold-added") std::printf("hold: %s\n", event.json.c_str());
                          if (event.kind == "item-accepted" && ++accepted == 2 * points) over.set_value();
                        });
  api::Plan plan = daemon::test::bench_plan({30}, steps(40.0, 0.4, 100), steps(10.0, 0.5, points / 100));
  plan.target_snr = 1.0;
  engine.command("bench", daemon::SubmitScan{daemon::test::new_scan(plan)}, [](const auto&) {});
  if (over.get_future().wait_for(std::chrono::minutes(10)) != std::future_status::ready) {
    throw std::runtime_error("no end; accepted " + std::to_string(accepted));
  }
  return 2.0 * static_cast<double>(points) / seconds_since(began);
}

// A page appended and made durable, as often as it goes: what a commit costs at the least.
double syncs_a_second(const std::string& file) {
  constexpr int kSyncs = 2000;
  const int fd = ::open(file.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC | O_TRUNC, 0600);
  const std::vector<char> page(4096, 'x');
  const auto began = SteadyClock::now();
  for (int n = 0; n < kSyncs; ++n) {
    if (::write(fd, page.data(), page.size()) < 0 || ::fdatasync(fd) != 0) break;
  }
  const double took_s = seconds_since(began);
  ::close(fd);
  std::filesystem::remove(file);
  return kSyncs / took_s;
}

void clean(const std::string& store) {
  for (const char* ending : {"", "-wal", "-shm", ".lock"}) std::filesystem::remove(store + ending);
}

}  // namespace

int main(int argc, char** argv) try {
  daemon::start_log("warning");
  const std::filesystem::path folder = argc > 1 ? argv[1] : ".";
  const long points = argc > 2 ? std::atol(argv[2]) : 5000;
  const std::string store = (folder / "bench_instant.sqlite").string();
  std::vector<double> rates;
  for (int round = 0; round < 3; ++round) {
    clean(store);
    const double syncs = syncs_a_second((folder / "bench_instant.sync").string());
    const double rate = engine_rate(store, points);
    rates.push_back(rate);
    std::printf("%7.0f items/s, each a move, an exposure and a durable commit; the disk alone: %7.0f synced pages/s\n",
                rate, syncs);
    std::fflush(stdout);
  }
  clean(store);
  std::ranges::sort(rates);
  const bool held = rates[rates.size() / 2] >= kLimit;
  std::printf("median %.0f, limit %.0f   %s\n", rates[rates.size() / 2], kLimit, held ? "held" : "NOT HELD");
  return held ? 0 : 1;
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
