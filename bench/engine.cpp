// What the engine adds to a point: sequencer, store and their messages, on a scripted instrument whose motion, exposure
// and wire pass on a manual clock and so cost nothing. The store is a real file, each item one durable commit.
// Usage: bench_engine [FOLDER]   (a folder on the disk to be measured; the working folder otherwise)
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/daemon/sequencer/scan_rig.h"

namespace {

using namespace gonio;
using namespace gonio::daemon;

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

std::vector<double> steps(double from, double step, int count) {
  std::vector<double> values;
  for (int n = 0; n < count; ++n) values.push_back(from + step * n);
  return values;
}

struct Cost {
  long points = 0;
  double cpu_ms = 0.0;  ///< a point: a sample item and its reference item
  double wall_ms = 0.0;
};

Cost measure(const std::string& store, int theta_r_count, int phi_count) {
  test::ScanRig rig(test::bench_instrument(), store);
  rig.submit(test::bench_plan({30}, steps(40.0, 45.0 / theta_r_count, theta_r_count), steps(10.0, 1.0, phi_count)));
  const double cpu = cpu_seconds();
  const auto wall = std::chrono::steady_clock::now();
  while (rig.step()) {
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - wall;
  const auto points = rig.count("SELECT count(*) FROM item WHERE outcome = 'accepted'") / 2;
  const auto n = static_cast<double>(points);
  return {points, 1e3 * (cpu_seconds() - cpu) / n, 1e3 * took.count() / n};
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const std::filesystem::path folder = argc > 1 ? argv[1] : ".";
  constexpr double kCpuLimitMs = 2.0;
  constexpr double kWallLimitMs = 5.0;
  bool within = true;
  std::printf("engine overhead a point (one sample and one reference item, each its own durable commit)\n");
  std::printf("%8s %12s %12s\n", "points", "CPU [ms]", "wall [ms]");
  for (const auto& [theta_r_count, phi_count] : {std::pair{10, 10}, {30, 33}, {45, 100}}) {
    const std::filesystem::path store = folder / "bench_engine.sqlite";
    const Cost cost = measure(store.string(), theta_r_count, phi_count);
    std::printf("%8ld %12.3f %12.3f\n", cost.points, cost.cpu_ms, cost.wall_ms);
    within = within && cost.points == theta_r_count * phi_count && cost.cpu_ms <= kCpuLimitMs &&
             cost.wall_ms <= kWallLimitMs;
    for (const char* ending : {"", "-wal", "-shm", ".lock"}) std::filesystem::remove(store.string() + ending);
  }
  std::printf("   limit %12.3f %12.3f   %s\n", kCpuLimitMs, kWallLimitMs, within ? "held" : "NOT HELD");
  return within ? 0 : 1;
}
