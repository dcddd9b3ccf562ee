#include "daemon/store/scan_history.h"

#include "daemon/store/database.h"
#include "daemon/store/schema.h"

namespace gonio::daemon {
namespace {

UtcTime history_time(std::int64_t ns) {
  return UtcTime(Duration(ns));
}

std::vector<HistoryReading> history_readings(Database& database, ScanId scan) {
  std::vector<HistoryReading> readings;
  Statement& query = database.statement(
      "SELECT d.utc_ns, v.kind IS 'dark', exposure_ns, mean_dn, monitor_mean, lamp_temperature_c, "
      "detector_temperature_c, room_temperature_c, humidity_percent, reading_id, d.attempt_id, d.visit_id, "
      "coalesce(v.kind, a.target) FROM reading d LEFT JOIN attempt a USING "
      "(attempt_id) LEFT JOIN visit v USING (visit_id) WHERE used = 1 AND (a.scan_id = ?1 OR v.scan_id = ?1) ORDER BY "
      "reading_id");
  query.bind(scan);
  while (query.next()) {
    readings.push_back({.reading = query.integer(9),
                        .of = query.text(12),
                        .at = history_time(query.integer(0)),
                        .is_dark = query.integer(1) != 0,
                        .exposure_s = in_seconds(Duration(query.integer(2))),
                        .mean_dn = query.real(3),
                        .monitor_mean = query.real(4),
                        .lamp_temperature_c = query.real(5),
                        .detector_temperature_c = query.real(6),
                        .room_temperature_c = query.real(7),
                        .humidity_percent = query.real(8)});
    if (!query.is_null(10)) readings.back().attempt = query.integer(10);
    if (!query.is_null(11)) readings.back().visit = query.integer(11);
  }
  return readings;
}

std::vector<HistoryVisit> history_visits(Database& database, ScanId scan) {
  std::vector<HistoryVisit> visits;
  Statement& query = database.statement(
      "SELECT v.utc_ns, v.kind, l.level, l.u_relative, l.drift FROM visit v JOIN visit_level l USING (visit_id) WHERE "
      "v.scan_id = ? ORDER BY visit_id");
  query.bind(scan);
  while (query.next()) {
    visits.push_back({.at = history_time(query.integer(0)),
                      .kind = query.text(1),
                      .level = query.real(2),
                      .u_relative = query.real(3)});
    if (!query.is_null(4)) visits.back().drift = query.real(4);
  }
  return visits;
}

std::vector<HistoryStep> history_steps(Database& database, ScanId scan) {
  std::vector<HistoryStep> steps;
  Statement& query = database.statement(
      "SELECT utc_ns, kind, who, json FROM event WHERE scan_id = ? AND kind NOT LIKE 'item-%' ORDER BY number");
  query.bind(scan);
  while (query.next()) {
    steps.push_back(
        {.at = history_time(query.integer(0)), .kind = query.text(1), .who = query.text(2), .json = query.text(3)});
  }
  return steps;
}

}  // namespace

Result<ScanHistory> scan_history(const std::string& store_file, ScanId scan) {
  auto opened = Database::open(store_file, Database::Mode::Read);
  if (!opened) return failure(opened.error());
  Database& database = **opened;
  GONIO_TRY(check_version(database));
  database.execute("BEGIN");
  ScanHistory history{.readings = history_readings(database, scan),
                      .visits = history_visits(database, scan),
                      .steps = history_steps(database, scan)};
  database.execute("COMMIT");
  GONIO_TRY(database.take_error());
  return history;
}

}  // namespace gonio::daemon
