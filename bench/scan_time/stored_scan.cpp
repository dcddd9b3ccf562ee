#include "bench/scan_time/stored_scan.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace gonio::bench {
namespace {

constexpr double kPerSecond = 1e-9;
using Places = stage::PerAxis<double>;

double trapezoid_s(double way, double speed, double acceleration) {
  const double length = std::abs(way);
  const double ramps = speed * speed / acceleration;
  return length < ramps ? 2.0 * std::sqrt(length / acceleration) : length / speed + speed / acceleration;
}

void add_step(ScanTimes& times, const drivers::StageConfig& stage, const Places& from, const Places& to) {
  double move_s = 0.0;
  double settle_s = 0.0;
  for (std::size_t a = 0; a < to.size(); ++a) {
    const drivers::AxisConfig& axis = stage.axes[a];
    const double way = std::abs(to[a] - from[a]);
    if (way <= axis.window) continue;
    move_s = std::max(move_s, trapezoid_s(way, axis.speed, axis.acceleration));
    settle_s = std::max(settle_s, in_seconds(axis.settle));
  }
  times.move_s += move_s;
  times.settle_s += settle_s;
}

void add_idle(ScanTimes& times, SQLite::Database& store, const std::string& table, long scan) {
  SQLite::Statement sum(store,
                        "SELECT total(idle_commit_ns), total(idle_wire_ns), total(idle_device_ns), "
                        "total(idle_hold_ns), total(idle_ns), total(read_ns), count(*) FROM " +
                            table + " WHERE scan_id = " + std::to_string(scan));
  sum.executeStep();
  const auto part = [&sum](int column) { return kPerSecond * sum.getColumn(column).getDouble(); };
  times.commit_s += part(0);
  times.wire_s += part(1);
  times.device_s += part(2);
  times.hold_s += part(3);
  times.planning_s += part(4) - part(0) - part(1) - part(2) - part(3);
  times.read_s += part(5);
  (table == "visit" ? times.visits : times.items) = sum.getColumn(6).getInt();
}

double instant_of(SQLite::Database& store, long scan, const std::string& kinds) {
  return kPerSecond * store
                          .execAndGet("SELECT boottime_ns FROM event WHERE scan_id = " + std::to_string(scan) +
                                      " AND kind IN (" + kinds + ") ORDER BY number LIMIT 1")
                          .getDouble();
}

}  // namespace

ScanTimes read_scan_times(const std::string& store_file, long scan, const drivers::StageConfig& stage) {
  SQLite::Database store(store_file, SQLite::OPEN_READONLY);
  ScanTimes times;
  times.wall_s =
      instant_of(store, scan, "'scan-done', 'scan-finished-early'") - instant_of(store, scan, "'scan-running'");
  SQLite::Statement readings(store,
                             "SELECT exposure_ns, open_theta_i_counts, open_theta_r_counts, open_phi_r_counts, "
                             "open_phi_i_counts, open_carriage_counts, open_filter_wheel_counts FROM reading r "
                             "LEFT JOIN attempt a USING (attempt_id) LEFT JOIN visit v USING (visit_id) WHERE "
                             "coalesce(a.scan_id, v.scan_id) = " +
                                 std::to_string(scan) + " ORDER BY reading_id");
  std::optional<Places> from;
  while (readings.executeStep()) {
    ++times.frames;
    times.expose_s += kPerSecond * readings.getColumn(0).getDouble();
    Places to{};
    for (std::size_t a = 0; a < to.size(); ++a) {
      const auto counts = static_cast<std::int32_t>(readings.getColumn(static_cast<int>(a) + 1).getInt());
      to[a] = drivers::position_of(stage, stage::kAllAxes[a], counts);
    }
    if (from) add_step(times, stage, *from, to);
    from = to;
  }
  add_idle(times, store, "attempt", scan);
  add_idle(times, store, "visit", scan);
  return times;
}

}  // namespace gonio::bench
