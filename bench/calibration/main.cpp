// Reducing a scan to BRDF with budgets: from memory, with the share of each step, and read and reduced from the store.
// Ends with 1 when a million points take a second or more from memory, or three or more with reading them (fewer points
// in proportion). Usage: bench_calibration [POINTS [ROUNDS [FOLDER]]]
//   FOLDER: where the store is written, some 1.3 kB a point; /tmp otherwise
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "bench/calibration/measured_time.h"
#include "bench/calibration/scan_grid.h"
#include "bench/calibration/stored_grid.h"
#include "calibration/calibrate.h"
#include "calibration/parallel_blocks.h"
#include "calibration/point_equation.h"
#include "calibration/reading_pairs.h"
#include "calibration/scan_histories.h"
#include "tests/support/temporary_folder.h"

namespace {

using namespace gonio;
using namespace gonio::calibration;
using bench::MeasuredTime;

constexpr double kLimitFromMemory_us = 1.0;  // of wall time, a point
constexpr double kLimitFromStore_us = 3.0;
const UtcTime kMeasuredOn{std::chrono::sys_days{std::chrono::year{2026} / 3 / 1}};

/// What a scan is reduced with.
struct Inputs {
  ReferenceStandard standard = bench::grid_standard();
  InstrumentModel instrument = bench::grid_instrument();
};

CalibratedScan reduced(const ScanReadings& scan, const Inputs& with, int threads = 0) {
  auto result = calibrate(scan, with.instrument, with.standard, kMeasuredOn, {.threads = threads});
  if (result && result->points.size() == scan.points.size()) return std::move(result).value();
  fmt::print("{}\n", result ? std::string("points without a value") : describe(result.error()));
  std::exit(2);
}

// Calls work(first, last) for all points, in blocks, on all threads.
void for_points(std::size_t points, const std::function<void(std::size_t, std::size_t)>& work) {
  constexpr std::size_t kPointsAtOnce = 4096;
  for_blocks((points + kPointsAtOnce - 1) / kPointsAtOnce, 0,
             [&](std::size_t block) { work(block * kPointsAtOnce, std::min(points, (block + 1) * kPointsAtOnce)); });
}

// As a reduction does: once for the value, and once more with what the budget needs beside it.
void equate_all(const ScanReadings& scan, const Inputs& with, const std::vector<ReadingPair>& pairs,
                const ScanHistories& histories) {
  const EquationContext context{
      .histories = &histories, .instrument = &with.instrument, .standard = &with.standard, .left_out = {}};
  for (const bool has_slopes : {false, true}) {
    for_points(pairs.size(), [&](std::size_t first, std::size_t last) {
      PairedPoint pair;
      for (std::size_t n = first; n < last; ++n) {
        if (!equate(scan.points[n], pairs[n], context, pair)) std::exit(2);
        if (has_slopes) add_standard_slopes(context, pair);
      }
    });
  }
}

std::vector<SlopePoint> places_of(const ScanReadings& scan, const CalibratedScan& calibrated) {
  std::vector<SlopePoint> places;
  for (std::size_t n = 0; n < scan.points.size(); ++n) {
    const CalibratedPoint& point = calibrated.points[n];
    places.push_back({.planned = scan.points[n].geometry,
                      .reported = point.geometry,
                      .wavelength = point.wavelength,
                      .value = point.value,
                      .u_random = point.budget.u_random});
  }
  return places;
}

/// A step of the reduction by itself, and how often it was timed.
struct Step {
  std::string name;
  std::vector<MeasuredTime> times;
};

// The steps are timed beside the whole, each alone: what they leave of it is the budget.
void time_steps(const ScanReadings& scan, const Inputs& with, const CalibratedScan& calibrated,
                std::vector<Step>& steps) {
  steps.resize(4);
  const auto add = [&](std::size_t step, const char* name, const std::function<void()>& work) {
    steps[step].name = name;
    steps[step].times.push_back(bench::time_of(work));
  };
  std::vector<ReadingPair> pairs;
  add(0, "pairs", [&] { pairs = pair_readings(scan); });
  add(1, "histories", [&] { const ScanHistories all(scan, with.instrument, {}); });
  const ScanHistories histories(scan, with.instrument, {});
  add(2, "equation, twice", [&] { equate_all(scan, with, pairs, histories); });
  const std::vector<SlopePoint> places = places_of(scan, calibrated);
  add(3, "lines and slopes", [&] {
    const SlopeField field(places, true, 0);
    for_points(places.size(), [&](std::size_t first, std::size_t last) {
      for (std::size_t n = first; n < last; ++n) (void)field.at(n);
    });
  });
}

void print(const std::string& name, const MeasuredTime& time, int points, double cpu_of_all_s) {
  fmt::print("  {:<28} {:7.3f} s  {:7.3f} s of processor, {:.2f} us a point", name, time.wall_s, time.cpu_s,
             1e6 * time.cpu_s / points);
  if (cpu_of_all_s > 0.0) fmt::print(", {:.0f} %", 100.0 * time.cpu_s / cpu_of_all_s);
  fmt::print("\n");
}

bool holds(const char* what, const MeasuredTime& time, int points, double limit_us) {
  const bool is_within = 1e6 * time.wall_s < limit_us * points;
  if (!is_within) fmt::print("  {}: {:.2f} us a point, limit {:.2f} us\n", what, 1e6 * time.wall_s / points, limit_us);
  return is_within;
}

bool bench_memory(const ScanReadings& scan, const Inputs& with, int rounds) {
  std::vector<MeasuredTime> whole;
  std::vector<MeasuredTime> single;
  std::vector<Step> steps;
  std::size_t terms = 0;
  for (int round = 0; round < rounds; ++round) {
    CalibratedScan calibrated;
    whole.push_back(bench::time_of([&] { calibrated = reduced(scan, with); }));
    terms = calibrated.points.front().budget.shared.size() + calibrated.points.front().budget.random.size();
    time_steps(scan, with, calibrated, steps);
    calibrated = {};
    if (round == 0) single.push_back(bench::time_of([&] { (void)reduced(scan, with, 1); }));
  }
  const MeasuredTime all = bench::median(whole);
  const auto points = static_cast<int>(scan.points.size());
  fmt::print("from memory: {} points, {} terms each, {} rounds, medians\n", points, terms, rounds);
  print("all threads", all, points, 0.0);
  print("all threads, first round", whole.front(), points, 0.0);  // into fresh pages, which the system clears
  print("one thread (one round)", bench::median(single), points, 0.0);
  MeasuredTime rest = all;
  for (const Step& step : steps) {
    const MeasuredTime time = bench::median(step.times);
    rest.wall_s -= time.wall_s;
    rest.cpu_s -= time.cpu_s;
    print("  " + step.name, time, points, all.cpu_s);
  }
  print("  budget, and the rest", rest, points, all.cpu_s);
  return holds("from memory", all, points, kLimitFromMemory_us);
}

bool bench_store(const ScanReadings& scan, const Inputs& with, int rounds, const std::filesystem::path& folder) {
  const test::TemporaryFolder own(folder);
  bench::StoredGrid stored;
  const MeasuredTime writing = bench::time_of([&] { stored = bench::write_grid(scan, own / "store.sqlite"); });
  std::vector<MeasuredTime> whole;
  std::vector<MeasuredTime> reading;
  for (int round = 0; round < rounds; ++round) {
    ScanReadings read;
    CalibratedScan calibrated;
    whole.push_back(bench::time_of([&] {
      reading.push_back(bench::time_of([&] { read = bench::read_grid(stored); }));
      calibrated = reduced(read, with);
    }));
  }
  const auto points = static_cast<int>(scan.points.size());
  const MeasuredTime all = bench::median(whole);
  const MeasuredTime reads = bench::median(reading);
  fmt::print("from the store: {} readings, {:.0f} MB, {} rounds, medians\n", scan.readings.size(),
             1e-6 * static_cast<double>(std::filesystem::file_size(stored.file)), rounds);
  print("read and reduced", all, points, 0.0);
  print("  reading", reads, points, all.cpu_s);
  print("  reducing", {all.wall_s - reads.wall_s, all.cpu_s - reads.cpu_s}, points, all.cpu_s);
  print("writing it (once, apart)", writing, points, 0.0);
  return holds("from the store", all, points, kLimitFromStore_us);
}

}  // namespace

int main(int argc, char** argv) {
  const int points = argc > 1 ? std::atoi(argv[1]) : 1'000'000;
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 5;
  const std::filesystem::path folder = argc > 3 ? argv[3] : "/tmp";
  const ScanReadings scan = bench::scan_grid(points);
  const Inputs with;
  const bool from_memory = bench_memory(scan, with, rounds);
  const bool from_store = bench_store(scan, with, rounds, folder);
  return from_memory && from_store ? 0 : 1;
}
