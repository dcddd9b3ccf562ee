// What the engine adds to a point: sequencer, store and their messages, on a scripted instrument whose motion, exposure
// and wire pass on a manual clock and so cost nothing. The store is a real file, each item one durable commit.
// Usage: bench_engine [FOLDER [MOST_POINTS [TSV]]]
//   FOLDER: on the disk to be measured; the working folder otherwise. MOST_POINTS: 10000; scans of 1000, 10 000 ... up
//   to it are run. TSV: every window of every scan is written there.
#include <gtest/gtest.h>

#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/daemon/sequencer/scan_rig.h"

namespace {

using namespace gonio;
using namespace gonio::daemon;
using SteadyClock = std::chrono::steady_clock;

constexpr double kCpuLimitMs = 2.0;
constexpr double kWallLimitMs = 5.0;
constexpr int kWindows = 10;

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double resident_mb() {
  std::ifstream statm("/proc/self/statm");
  double size = 0.0;
  double resident = 0.0;
  statm >> size >> resident;
  return 1e-6 * resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

std::vector<double> steps(double from, double step, long count) {
  std::vector<double> values;
  for (long n = 0; n < count; ++n) values.push_back(from + step * static_cast<double>(n));
  return values;
}

/// A tenth of a scan. A point is a sample item and its reference item.
struct Window {
  double cpu_ms = 0.0;
  double wall_ms = 0.0;
  double slowest_ms = 0.0;  ///< 99 of 100 items take less, times two
  double resident_mb = 0.0;
};

struct Run {
  long points = 0;
  double submit_s = 0.0;
  std::vector<Window> windows;
};

class Stopwatch {
 public:
  explicit Stopwatch(long items) : items_(items) {}

  void item_is_committed() {
    const auto now = SteadyClock::now();
    latencies_ms_.push_back(1e3 * std::chrono::duration<double>(now - last_).count());
    last_ = now;
    if (static_cast<long>(latencies_ms_.size()) == items_ / kWindows) end_window(now);
  }
  void begin() {
    last_ = began_ = SteadyClock::now();
    cpu_ = cpu_seconds();
  }
  [[nodiscard]] std::vector<Window> take() { return std::move(windows_); }

 private:
  void end_window(SteadyClock::time_point now) {
    const double points = 0.5 * static_cast<double>(latencies_ms_.size());
    const auto slow =
        latencies_ms_.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(latencies_ms_.size()));
    std::nth_element(latencies_ms_.begin(), slow, latencies_ms_.end());
    const double cpu = cpu_seconds();
    windows_.push_back({.cpu_ms = 1e3 * (cpu - cpu_) / points,
                        .wall_ms = 1e3 * std::chrono::duration<double>(now - began_).count() / points,
                        .slowest_ms = 2.0 * *slow,
                        .resident_mb = resident_mb()});
    latencies_ms_.clear();
    cpu_ = cpu;
    began_ = now;
  }

  long items_;
  double cpu_ = 0.0;
  SteadyClock::time_point began_;
  SteadyClock::time_point last_;
  std::vector<double> latencies_ms_;
  std::vector<Window> windows_;
};

// All steps as long, so that only the number of points differs.
Run measure(const std::string& store, long points) {
  const long across = points < 100'000 ? 20 : 200;
  const long down = points / across;
  daemon::test::ScanRig rig(daemon::test::bench_instrument(), store);
  Stopwatch watch(2 * points);
  rig.on_event = [&watch](const EventRecord& event) {
    if (event.kind == "scan-running") watch.begin();
    if (event.kind == "item-accepted") watch.item_is_committed();
  };
  const auto began = SteadyClock::now();
  api::Plan plan =
      daemon::test::bench_plan({30}, steps(40.0, 0.2, across), steps(10.0, 100.0 / static_cast<double>(down), down));
  plan.target_snr = 100.0;
  const CommandId id = rig.command(SubmitScan{daemon::test::new_scan(plan)});
  while (rig.reply_to(id) == nullptr && rig.step()) {
  }
  Run run{.points = points, .submit_s = std::chrono::duration<double>(SteadyClock::now() - began).count()};
  while (rig.step()) {
  }
  run.windows = watch.take();
  return run;
}

double mean_of(const Run& run, double Window::*part) {
  double sum = 0.0;
  for (const Window& window : run.windows) sum += window.*part;
  return sum / static_cast<double>(run.windows.size());
}

bool print(const Run& run) {
  const Window& first = run.windows.front();
  const Window& last = run.windows.back();
  const double cpu_ms = mean_of(run, &Window::cpu_ms);
  const double wall_ms = mean_of(run, &Window::wall_ms);
  std::printf("%8ld %9.2f %9.3f %9.3f %9.3f %9.3f %9.3f %9.3f %9.1f %9.1f\n", run.points, run.submit_s, cpu_ms,
              first.cpu_ms, last.cpu_ms, wall_ms, first.wall_ms, last.wall_ms, first.resident_mb, last.resident_mb);
  std::fflush(stdout);
  return static_cast<int>(run.windows.size()) == kWindows && cpu_ms <= kCpuLimitMs && wall_ms <= kWallLimitMs;
}

void write(std::ofstream& tsv, const Run& run) {
  int n = 0;
  for (const Window& window : run.windows) {
    tsv << run.points << '\t' << static_cast<double>(run.points) * ++n / kWindows << '\t' << window.cpu_ms << '\t'
        << window.wall_ms << '\t' << window.slowest_ms << '\t' << window.resident_mb << '\n';
  }
  tsv << "\n\n" << std::flush;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const std::filesystem::path folder = argc > 1 ? argv[1] : ".";
  const long most = argc > 2 ? std::atol(argv[2]) : 10'000;
  std::ofstream tsv;
  if (argc > 3) tsv.open(argv[3]);
  tsv << "# points\tdone\tcpu_ms\twall_ms\tp99_ms\tresident_mb   (a point: sample and reference item)\n";
  bool within = true;
  std::printf("engine overhead a point (one sample and one reference item, each its own durable commit)\n");
  std::printf("%8s %9s %29s %29s %19s\n", "", "submit", "CPU [ms]: mean, first, last", "wall [ms]: mean, first, last",
              "resident [MB]");
  for (long points = 1000; points <= most; points *= 10) {
    const std::filesystem::path store = folder / "bench_engine.sqlite";
    const Run run = measure(store.string(), points);
    within = print(run) && within;
    write(tsv, run);
    for (const char* ending : {"", "-wal", "-shm", ".lock"}) std::filesystem::remove(store.string() + ending);
  }
  std::printf("   limits: CPU %.1f ms, wall %.1f ms   %s\n", kCpuLimitMs, kWallLimitMs, within ? "held" : "NOT HELD");
  return within ? 0 : 1;
}
