#include "daemon/store/point_trace.h"

#include <algorithm>

#include "daemon/store/database.h"
#include "daemon/store/schema.h"

namespace gonio::daemon {
namespace {

std::string utc_text(std::int64_t ns) {
  return iso8601(UtcTime(Duration(ns)));
}

// Columns as in the two queries below.
TracedReading traced_reading(const Statement& row) {
  TracedReading reading{.reading = row.integer(0),
                        .sequence = static_cast<int>(row.integer(1)),
                        .used = row.integer(2) != 0,
                        .pixels = row.integer(3),
                        .mean_dn = row.real(4),
                        .m2_dn2 = row.real(5),
                        .m3_dn3 = row.real(6),
                        .m4_dn4 = row.real(7),
                        .saturated = row.integer(8),
                        .exposure_s = in_seconds(Duration(row.integer(9))),
                        .gain_db = row.real(10),
                        .monitor_mean = row.real(11),
                        .monitor_se = row.real(12),
                        .utc = utc_text(row.integer(13))};
  if (!row.is_null(14)) reading.power_w = row.real(14);
  return reading;
}

std::vector<TracedReading> readings_of_attempt(Database& database, std::int64_t attempt) {
  std::vector<TracedReading> readings;
  Statement& query = database.statement(
      "SELECT reading_id, sequence, used, region_n, mean_dn, m2_dn2, m3_dn3, m4_dn4, saturated, exposure_ns, gain_db, "
      "monitor_mean, monitor_se, utc_ns, mean_w FROM reading LEFT JOIN (SELECT reading_id AS of_reading, mean_w FROM "
      "power_reading WHERE role = 'detector') ON of_reading = reading_id WHERE attempt_id = ? ORDER BY sequence");
  query.bind(attempt);
  while (query.next()) readings.push_back(traced_reading(query));
  return readings;
}

std::vector<TracedReading> readings_of_visit(Database& database, std::int64_t visit) {
  std::vector<TracedReading> readings;
  Statement& query = database.statement(
      "SELECT reading_id, sequence, used, region_n, mean_dn, m2_dn2, m3_dn3, m4_dn4, saturated, exposure_ns, gain_db, "
      "monitor_mean, monitor_se, utc_ns, mean_w FROM reading LEFT JOIN (SELECT reading_id AS of_reading, mean_w FROM "
      "power_reading WHERE role = 'detector') ON of_reading = reading_id WHERE visit_id = ? ORDER BY sequence");
  query.bind(visit);
  while (query.next()) readings.push_back(traced_reading(query));
  return readings;
}

std::vector<TracedAttempt> attempts_of(Database& database, ScanId scan, std::int32_t point) {
  std::vector<TracedAttempt> attempts;
  Statement& query = database.statement(
      "SELECT a.attempt_id, a.target, a.number, a.outcome, a.error, a.utc_ns, coalesce(i.round, 0), "
      "coalesce(i.round = (SELECT max(round) FROM item l WHERE l.scan_id = a.scan_id AND l.point_index = "
      "a.point_index AND l.target = a.target AND l.outcome = 'accepted'), 0) "
      "FROM attempt a LEFT JOIN item i ON i.attempt_id = a.attempt_id WHERE a.scan_id = ? AND a.point_index = ? "
      "ORDER BY a.attempt_id");
  query.bind(scan).bind(point);
  while (query.next()) {
    attempts.push_back({.attempt = query.integer(0),
                        .target = query.text(1),
                        .number = static_cast<int>(query.integer(2)),
                        .outcome = query.text(3),
                        .error = query.text(4),
                        .in_force = query.integer(7) != 0,
                        .round = static_cast<int>(query.integer(6)),
                        .utc = utc_text(query.integer(5))});
  }
  for (TracedAttempt& attempt : attempts) attempt.readings = readings_of_attempt(database, attempt.attempt);
  return attempts;
}

// Attempts and visits are told apart in time by the order of their readings' commits: `after_attempt` of a visit.
std::vector<TracedVisit> darks_about(Database& database, ScanId scan, const std::vector<TracedAttempt>& attempts) {
  std::vector<TracedVisit> darks;
  const auto add = [&](Statement& query) {
    while (query.next()) {
      darks.push_back({.visit = query.integer(0), .kind = query.text(1), .utc = utc_text(query.integer(2))});
    }
  };
  for (const TracedAttempt& attempt : attempts) {
    if (!attempt.in_force) continue;
    Statement& before = database.statement(
        "SELECT visit_id, kind, utc_ns FROM visit WHERE scan_id = ? AND kind = 'dark' AND after_attempt < ? ORDER BY "
        "visit_id DESC LIMIT 1");
    add(before.bind(scan).bind(attempt.attempt));
    Statement& after = database.statement(
        "SELECT visit_id, kind, utc_ns FROM visit WHERE scan_id = ? AND kind = 'dark' AND after_attempt >= ? ORDER BY "
        "visit_id LIMIT 1");
    add(after.bind(scan).bind(attempt.attempt));
  }
  std::ranges::sort(darks, {}, &TracedVisit::visit);
  const auto is_same = [](const TracedVisit& a, const TracedVisit& b) { return a.visit == b.visit; };
  darks.erase(std::unique(darks.begin(), darks.end(), is_same), darks.end());
  for (TracedVisit& dark : darks) dark.readings = readings_of_visit(database, dark.visit);
  return darks;
}

}  // namespace

Result<PointTrace> trace_point(const std::string& store_file, ScanId scan, std::int32_t point) {
  auto opened = Database::open(store_file, Database::Mode::Read);
  if (!opened) return failure(opened.error());
  Database& database = **opened;
  GONIO_TRY(check_version(database));
  database.execute("BEGIN");
  PointTrace trace;
  trace.attempts = attempts_of(database, scan, point);
  trace.darks = darks_about(database, scan, trace.attempts);
  database.execute("COMMIT");
  GONIO_TRY(database.take_error());
  return trace;
}

}  // namespace gonio::daemon
