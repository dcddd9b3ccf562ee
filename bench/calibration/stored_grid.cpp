#include "bench/calibration/stored_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "daemon/store/store_reader.h"
#include "daemon/store/store_writer.h"
#include "drivers/stage_config.h"
#include "tests/daemon/support/scan_records.h"

namespace gonio::bench {
namespace {

using namespace gonio::daemon;
using calibration::RawFrame;
using calibration::RawReading;
using calibration::Target;
using stage::Axis;

template <class T>
T value_of(Result<T> result) {
  if (result) return std::move(result).value();
  fmt::print("{}\n", describe(result.error()));
  std::exit(2);
}

drivers::StageConfig grid_stage() {
  drivers::StageConfig stage = daemon::test::bench_instrument().stage;
  stage.registers.axis_scale.fill(1e-4);
  return stage;
}

stage::PerAxis<std::int32_t> counts_at(const drivers::StageConfig& stage, const Geometry& g) {
  stage::PerAxis<std::int32_t> counts{};
  for (const auto& [axis, angle] : {std::pair(Axis::ThetaI, g.theta_i), std::pair(Axis::ThetaR, g.theta_r),
                                    std::pair(Axis::PhiI, g.phi_i), std::pair(Axis::PhiR, g.phi_r)}) {
    counts[stage::index_of(axis)] = static_cast<std::int32_t>(drivers::counts_of(stage, axis, in_degrees(angle)));
  }
  return counts;
}

ReadingRecord record_of(const RawReading& reading, const drivers::StageConfig& stage) {
  const RawFrame& frame = reading.frames.front();
  ReadingRecord record = daemon::test::reading_of(frame.region.mean, reading.at, seconds(frame.exposure_s));
  record.region = frame.region;
  record.monitor_mean = frame.monitor_mean;
  record.monitor_se = frame.monitor_se;
  record.open_counts = counts_at(stage, frame.at_open);
  record.close_counts = counts_at(stage, frame.at_close);
  return record;
}

StoreWrite write_of(const RawReading& reading, ScanId scan, const drivers::StageConfig& stage) {
  if (reading.point_index) {
    return NewAttempt{.scan = scan,
                      .item = {.point = *reading.point_index, .target = reading.target},
                      .readings = {record_of(reading, stage)},
                      .started = reading.at};
  }
  NewVisit visit{.scan = scan, .readings = {record_of(reading, stage)}, .started = reading.at};
  if (reading.visited_point) {
    visit.kind = VisitKind::Reference;
    visit.level = VisitLevel{.point = *reading.visited_point, .level = 1.0, .u_relative = 1e-3};
  }
  return visit;
}

NewScan scan_of(const calibration::ScanReadings& readings) {
  NewScan scan = daemon::test::new_scan(daemon::test::bench_plan({30}, {10}, {90}));
  scan.planned.points.clear();
  scan.planned.order.clear();
  for (const calibration::PlannedPoint& point : readings.points) {
    scan.planned.points.push_back(
        {.index = point.index, .rank = point.index, .geometry = point.geometry, .wavelength = point.wavelength});
    scan.planned.order.push_back(point.index);
  }
  return scan;
}

}  // namespace

StoredGrid write_grid(const calibration::ScanReadings& readings, const std::string& file) {
  constexpr std::size_t kReadingsOfACommit = 20000;
  StoredGrid stored{.file = file, .stage = grid_stage()};
  ManualClock clock;
  const auto writer = value_of(StoreWriter::open({.path = file, .boot_id = "bench", .version = "bench"}, clock));
  stored.scan = value_of(writer->commit({.at = clock.now(), .writes = {scan_of(readings)}})).new_scan;
  for (std::size_t first = 0; first < readings.readings.size(); first += kReadingsOfACommit) {
    StoreTransaction transaction{.at = clock.now()};
    const std::size_t last = std::min(readings.readings.size(), first + kReadingsOfACommit);
    for (std::size_t n = first; n < last; ++n) {
      transaction.writes.push_back(write_of(readings.readings[n], stored.scan, stored.stage));
    }
    (void)value_of(writer->commit(transaction));
  }
  return stored;
}

calibration::ScanReadings read_grid(const StoredGrid& stored) {
  const auto reader = value_of(StoreReader::open(stored.file));
  return value_of(reader->readings(stored.scan, stored.stage));
}

}  // namespace gonio::bench
