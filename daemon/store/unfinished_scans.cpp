#include "daemon/store/unfinished_scans.h"

#include <algorithm>
#include <limits>
#include <string_view>

#include "daemon/store/exposure_list.h"
#include "daemon/store/policy_names.h"

namespace gonio::daemon {

namespace {

template <class E, std::size_t N>
E enum_at(const std::array<std::string_view, N>& names, std::string_view name) {
  return static_cast<E>(std::find(names.begin(), names.end(), name) - names.begin());
}

ItemKey item_from_row(const Statement& row, int first) {
  return ItemKey{.point = static_cast<std::int32_t>(row.integer(first)),
                 .target = target_from_name(row.text(first + 1)).value_or(calibration::Target::Sample)};
}

void read_items(Database& database, UnfinishedScan& scan) {
  Statement& query =
      database.statement("SELECT point_index, target, outcome FROM decided_item WHERE scan_id = ?").bind(scan.id);
  while (query.next()) {
    auto& list = query.text(2) == "accepted" ? scan.accepted : scan.skipped;
    list.push_back(item_from_row(query, 0));
  }
}

void read_attempts(Database& database, UnfinishedScan& scan) {
  Statement& query = database
                         .statement(
                             "SELECT point_index, target, count(*) FROM attempt a WHERE scan_id = ? AND outcome = "
                             "'failed' AND NOT EXISTS (SELECT 1 FROM decided_item i WHERE i.scan_id = a.scan_id AND "
                             "i.point_index = a.point_index AND i.target = a.target) AND attempt_id > coalesce(("
                             "SELECT max(attempt_id) FROM item e WHERE e.scan_id = a.scan_id AND e.point_index = "
                             "a.point_index AND e.target = a.target), 0) GROUP BY 1, 2")
                         .bind(scan.id);
  while (query.next()) scan.attempts.emplace_back(item_from_row(query, 0), static_cast<int>(query.integer(2)));
}

void read_dark_needs(Database& database, UnfinishedScan& scan) {
  Statement& rungs = database
                         .statement(
                             "SELECT exposure_ns FROM item JOIN reading USING (attempt_id) WHERE "
                             "scan_id = ?1 AND used = 1 UNION SELECT exposure_ns FROM visit_level JOIN reading USING "
                             "(visit_id) WHERE scan_id = ?1 AND used = 1 ORDER BY 1")
                         .bind(scan.id);
  while (rungs.next()) scan.exposures_used.push_back(Duration(rungs.integer(0)));
  Statement& owed = database
                        .statement(
                            "SELECT EXISTS (SELECT 1 FROM item WHERE scan_id = ?1 AND attempt_id > coalesce("
                            "(SELECT max(after_attempt) FROM visit WHERE scan_id = ?1 AND kind = 'dark'), 0)) OR "
                            "EXISTS (SELECT 1 FROM visit_level WHERE scan_id = ?1 AND visit_id > coalesce("
                            "(SELECT max(visit_id) FROM visit WHERE scan_id = ?1 AND kind = 'dark'), 0))")
                        .bind(scan.id);
  while (owed.next()) scan.dark_owed = owed.integer(0) != 0;
}

LastVisit read_last_visit(Database& database, ScanId scan, VisitKind kind) {
  LastVisit last;
  std::int64_t after_attempt = 0;
  Statement& visit = database
                         .statement(
                             "SELECT after_attempt, point_index, level, u_relative FROM visit v JOIN visit_level l "
                             "USING (visit_id) WHERE v.scan_id = ? AND kind = ? ORDER BY visit_id DESC LIMIT 1")
                         .bind(scan)
                         .bind(visit_kind_name(kind));
  while (visit.next()) {
    after_attempt = visit.integer(0);
    last.level = VisitLevel{.point = static_cast<std::int32_t>(visit.integer(1)),
                            .level = visit.real(2),
                            .u_relative = visit.real(3),
                            .drift = std::nullopt};
  }
  Statement& since = database
                         .statement(
                             "SELECT point_index, target FROM decided_item WHERE scan_id = ? AND attempt_id > ? "
                             "ORDER BY attempt_id")
                         .bind(scan)
                         .bind(after_attempt);
  while (since.next()) last.since.push_back(item_from_row(since, 0));
  return last;
}

void read_drift(Database& database, UnfinishedScan& scan) {
  scan.last_reference = read_last_visit(database, scan.id, VisitKind::Reference);
  scan.last_check = read_last_visit(database, scan.id, VisitKind::Check);
  Statement& reopened =
      database.statement("SELECT point_index, max(round) FROM reopening WHERE scan_id = ? GROUP BY 1").bind(scan.id);
  while (reopened.next()) {
    scan.reopened.emplace_back(static_cast<std::int32_t>(reopened.integer(0)), static_cast<int>(reopened.integer(1)));
  }
  scan.largest_drift = read_largest_drift(database, scan.id);
}

void read_prediction(Database& database, UnfinishedScan& scan) {
  Statement& query = database
                         .statement(
                             "SELECT motion_ns + expose_ns + beyond_ns, u_s, motion_ratio, u_motion_ratio, scans FROM "
                             "prediction WHERE scan_id = ?")
                         .bind(scan.id);
  while (query.next()) {
    scan.predicted = PredictedTime{.total = Duration(query.integer(0)),
                                   .u_s = query.real(1),
                                   .motion = {query.real(2), query.real(3)},
                                   .scans = query.integer(4)};
  }
}

void complete(Database& database, UnfinishedScan& scan, Instant now, UtcTime utc_now) {
  read_prediction(database, scan);
  scan.turn = read_turn(database, scan.id, now, utc_now);
  scan.points = read_points(database, scan.id, -1, std::numeric_limits<std::int64_t>::max());
  for (const ScanPoint& point : scan.points) {
    if (!point.blocked) scan.order.push_back(point.index);
  }
  std::sort(scan.order.begin(), scan.order.end(), [&scan](std::int32_t a, std::int32_t b) {
    return scan.points[static_cast<std::size_t>(a)].rank < scan.points[static_cast<std::size_t>(b)].rank;
  });
  read_items(database, scan);
  read_attempts(database, scan);
  read_dark_needs(database, scan);
  read_drift(database, scan);
  scan.holds = read_holds(database, scan.id, now, utc_now);
  scan.spent = read_time_spent(database, scan.id);
}

}  // namespace

ScanPolicy policy_from_row(const Statement& row, int first) {
  return ScanPolicy{.target_snr = row.real(first),
                    .max_time = Duration(row.integer(first + 1)),
                    .exposures = exposure_list_from(row.text(first + 2)),
                    .block = Duration(row.integer(first + 3)),
                    .dark_every = Duration(row.integer(first + 4)),
                    .item_retries = static_cast<int>(row.integer(first + 5)),
                    .on_item_error = enum_at<api::OnItemError>(kOnItemErrorNames, row.text(first + 6)),
                    .on_restart = enum_at<api::OnRestart>(kOnRestartNames, row.text(first + 7)),
                    .reference_every = Duration(row.integer(first + 8)),
                    .check_every = Duration(row.integer(first + 9)),
                    .drift_limit = row.real(first + 10),
                    .drift_rounds = static_cast<int>(row.integer(first + 11)),
                    .reference_mode = enum_at<api::ReferenceMode>(kReferenceModeNames, row.text(first + 12)),
                    .anchor = {.theta_i = degrees(row.real(first + 13)),
                               .phi_i = {},
                               .theta_r = degrees(row.real(first + 14)),
                               .phi_r = degrees(row.real(first + 15))},
                    .map_frames = static_cast<int>(row.integer(first + 16))};
}

std::vector<ScanPoint> read_points(Database& database, ScanId scan, std::int32_t after, std::int64_t at_most) {
  std::vector<ScanPoint> points;
  Statement& query = database
                         .statement(
                             "SELECT point_index, rank, theta_i_deg, phi_i_deg, theta_r_deg, phi_r_deg, "
                             "wavelength_nm, blocked, repeat FROM point WHERE scan_id = ? AND point_index > ? "
                             "ORDER BY point_index LIMIT ?")
                         .bind(scan)
                         .bind(after)
                         .bind(at_most);
  while (query.next()) {
    points.push_back(ScanPoint{.index = static_cast<std::int32_t>(query.integer(0)),
                               .rank = static_cast<std::int32_t>(query.integer(1)),
                               .geometry = {.theta_i = degrees(query.real(2)),
                                            .phi_i = degrees(query.real(3)),
                                            .theta_r = degrees(query.real(4)),
                                            .phi_r = degrees(query.real(5))},
                               .wavelength = nanometres(query.real(6)),
                               .blocked = query.integer(7) != 0,
                               .repeat = static_cast<int>(query.integer(8))});
  }
  return points;
}

std::vector<Hold> read_holds(Database& database, ScanId scan, Instant now, UtcTime utc_now) {
  std::vector<Hold> holds;
  Statement& query = database
                         .statement(
                             "SELECT name, owner, reason, since_utc_ns FROM hold WHERE scan_id = ? AND "
                             "cleared_utc_ns IS NULL ORDER BY hold_id")
                         .bind(scan);
  while (query.next()) {
    // The wall clock may have been set back since.
    const Duration ago = std::max(Duration::zero(), utc_now.time_since_epoch() - Duration(query.integer(3)));
    holds.push_back(Hold{.name = hold_from_name(query.text(0)).value_or(HoldName::Operator),
                         .owner = query.text(1),
                         .reason = query.text(2),
                         .since = now - ago});
  }
  return holds;
}

ScanTurn read_turn(Database& database, ScanId scan, Instant now, UtcTime utc_now) {
  ScanTurn turn;
  Statement& query =
      database.statement("SELECT priority, preempts, start_utc_ns, completes_scan_id FROM scan_turn WHERE scan_id = ?")
          .bind(scan);
  while (query.next()) {
    turn.priority = static_cast<int>(query.integer(0));
    turn.preempts = query.integer(1) != 0;
    if (!query.is_null(2)) {
      const UtcTime utc{Duration(query.integer(2))};
      turn.start = ScanTurn::Start{.at = now + (utc - utc_now), .utc = utc};
    }
    if (!query.is_null(3)) turn.completes = query.integer(3);
  }
  return turn;
}

double read_largest_drift(Database& database, ScanId scan) {
  double largest = 0.0;
  Statement& query =
      database.statement("SELECT coalesce(max(abs(drift)), 0.0) FROM visit_level WHERE scan_id = ?").bind(scan);
  while (query.next()) largest = query.real(0);
  return largest;
}

TimeParts read_time_spent(Database& database, ScanId scan) {
  TimeParts spent;
  Statement& query = database
                         .statement(
                             "SELECT total(move_ns), total(settle_ns), total(expose_ns), total(read_ns), "
                             "total(idle_ns), total(idle_commit_ns), total(idle_wire_ns), total(idle_device_ns), "
                             "total(idle_hold_ns) FROM (SELECT move_ns, settle_ns, expose_ns, read_ns, idle_ns, "
                             "idle_commit_ns, idle_wire_ns, idle_device_ns, idle_hold_ns FROM attempt WHERE scan_id = "
                             "?1 UNION ALL SELECT move_ns, settle_ns, expose_ns, read_ns, idle_ns, idle_commit_ns, "
                             "idle_wire_ns, idle_device_ns, idle_hold_ns FROM visit WHERE scan_id = ?1)")
                         .bind(scan);
  while (query.next()) {
    const auto part = [&query](int column) { return Duration(static_cast<std::int64_t>(query.real(column))); };
    spent = {.move = part(0),
             .settle = part(1),
             .expose = part(2),
             .read = part(3),
             .idle = {.commit = part(5), .wire = part(6), .device = part(7), .hold = part(8)}};
    spent.idle.planning = part(4) - spent.idle.total();
  }
  return spent;
}

std::vector<UnfinishedScan> read_unfinished(Database& database, Instant now, UtcTime utc_now) {
  std::vector<UnfinishedScan> scans;
  Statement& query = database.statement(
      "SELECT scan_id, state, finish_asked, name, isotropic, configuration_hash, merged, target_snr, max_time_ns, "
      "exposures_ns, "
      "block_ns, dark_every_ns, item_retries, on_item_error, on_restart, reference_every_ns, check_every_ns, "
      "drift_limit, drift_rounds, reference_mode, anchor_theta_i_deg, anchor_theta_r_deg, anchor_phi_r_deg, map_frames "
      "FROM scan "
      "WHERE state NOT IN ('done', 'finished-early', 'aborted', 'failed') ORDER BY scan_id");
  while (query.next()) {
    scans.push_back(UnfinishedScan{.id = query.integer(0),
                                   .state = scan_state_from_name(query.text(1)).value_or(ScanState::Failed),
                                   .finish_asked = query.integer(2) != 0,
                                   .name = query.text(3),
                                   .policy = policy_from_row(query, 7),
                                   .isotropic = query.integer(4) != 0,
                                   .instrument_hash = query.text(5),
                                   .merged = query.integer(6)});
  }
  for (UnfinishedScan& scan : scans) complete(database, scan, now, utc_now);
  return scans;
}

}  // namespace gonio::daemon
