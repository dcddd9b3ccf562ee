#include "daemon/store/scan_readings.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "calibration/parallel_blocks.h"
#include "daemon/store/reading_rows.h"
#include "daemon/store/unfinished_scans.h"

namespace gonio::daemon {
namespace {

using calibration::PlannedPoint;
using calibration::RawReading;
using calibration::ScanReadings;
using calibration::Target;

// [n]: what `read(connection, ranges[n])` finds on a connection of its own.
template <class Part, class Range, class Read>
Result<std::vector<Part>> read_parts(const std::string& path, const std::vector<Range>& ranges, const Read& read) {
  std::vector<Part> parts(ranges.size());
  std::vector<Result<void>> outcomes(ranges.size());
  calibration::for_blocks(ranges.size(), 0, [&](std::size_t n) {
    auto connection = Database::open(path, Database::Mode::Read);
    if (!connection) {
      outcomes[n] = failure(std::move(connection).error());
      return;
    }
    parts[n] = read(**connection, ranges[n]);
    outcomes[n] = (*connection)->take_error();
  });
  for (Result<void>& outcome : outcomes) GONIO_TRY(std::move(outcome));
  return parts;
}

template <class List>
List joined(std::vector<List> parts) {
  std::size_t size = 0;
  for (const List& part : parts) size += part.size();
  List all;
  all.reserve(size);
  for (List& part : parts) {
    std::move(part.begin(), part.end(), std::back_inserter(all));
    part = {};
  }
  return all;
}

std::optional<std::int64_t> integer_or_none(Statement& query) {
  std::optional<std::int64_t> found;
  while (query.next()) {
    if (!query.is_null(0)) found = query.integer(0);
  }
  return found;
}

// Equal parts of a range, each of some thousands of rows.
std::vector<IdRange> parts_of(IdRange range) {
  constexpr std::int64_t kRowsOfAPart = 65536;
  const std::int64_t rows = std::max<std::int64_t>(0, range.to - range.from);
  const std::int64_t parts = std::max<std::int64_t>(1, rows / kRowsOfAPart);
  std::vector<IdRange> all;
  for (std::int64_t n = 0; n < parts; ++n) {
    all.push_back({range.from + rows * n / parts, range.from + rows * (n + 1) / parts});
  }
  return all;
}

std::vector<PlannedPoint> read_planned(Database& database, ScanId scan, IdRange range) {
  std::vector<PlannedPoint> points;
  points.reserve(static_cast<std::size_t>(range.to - range.from));
  Statement& query = database.statement(
      "SELECT point_index, theta_i_deg, phi_i_deg, theta_r_deg, phi_r_deg, wavelength_nm, blocked FROM point WHERE "
      "scan_id = ? "
      "AND point_index >= ? AND point_index < ? ORDER BY point_index");
  query.bind(scan).bind(range.from).bind(range.to);
  while (query.next()) {
    points.push_back({.index = static_cast<std::int32_t>(query.integer(0)),
                      .geometry = {.theta_i = degrees(query.real(1)),
                                   .phi_i = degrees(query.real(2)),
                                   .theta_r = degrees(query.real(3)),
                                   .phi_r = degrees(query.real(4))},
                      .wavelength = nanometres(query.real(5)),
                      .is_blocked = query.integer(6) != 0});
  }
  return points;
}

IdRange points_of(Database& database, ScanId scan) {
  Statement& query = database.statement("SELECT max(point_index) FROM point WHERE scan_id = ?");
  return {0, integer_or_none(query.bind(scan)).value_or(-1) + 1};
}

IdRange attempts_of(Database& database, ScanId scan) {
  Statement& first = database.statement("SELECT min(attempt_id) FROM attempt WHERE scan_id = ?");
  Statement& last = database.statement("SELECT max(attempt_id) FROM attempt WHERE scan_id = ?");
  const std::int64_t from = integer_or_none(first.bind(scan)).value_or(0);
  return {from, integer_or_none(last.bind(scan)).value_or(from - 1) + 1};
}

std::int64_t first_reading_from(Database& database, std::int64_t attempt, std::int64_t otherwise) {
  Statement& query =
      database.statement("SELECT reading_id FROM reading WHERE attempt_id >= ? ORDER BY attempt_id, sequence LIMIT 1");
  return integer_or_none(query.bind(attempt)).value_or(otherwise);
}

// Rows are written in the order of their attempts and visits, and those of one attempt together: what lies between the
// first rows of two attempts are whole attempts and whole visits. Rows of other scans may lie among them.
std::vector<ReadingPart> reading_parts(Database& database, ScanId scan) {
  Statement& of_visits = database.statement(
      "SELECT min(reading_id), max(reading_id) FROM visit JOIN reading USING (visit_id) WHERE scan_id = ?");
  IdRange all{0, 0};
  of_visits.bind(scan);
  while (of_visits.next()) {
    if (!of_visits.is_null(0)) all = {of_visits.integer(0), of_visits.integer(1) + 1};
  }
  const IdRange attempts = attempts_of(database, scan);
  if (attempts.from == attempts.to) return {{.readings = all, .attempts = attempts}};
  Statement& last = database.statement(
      "SELECT reading_id FROM reading WHERE attempt_id < ? ORDER BY attempt_id DESC, sequence DESC LIMIT 1");
  const std::int64_t end = std::max(all.to, integer_or_none(last.bind(attempts.to)).value_or(-1) + 1);
  const std::int64_t begin = first_reading_from(database, attempts.from, end);
  std::vector<ReadingPart> parts;
  std::int64_t from = all.to == 0 ? begin : std::min(all.from, begin);
  for (const IdRange& part : parts_of(attempts)) {
    const std::int64_t to = part.to == attempts.to ? end : first_reading_from(database, part.to, end);
    parts.push_back({.readings = {from, to}, .attempts = part});
    from = to;
  }
  return parts;
}

// One scale for readings of several boots: boot time within each, and UTC at each boot's first run between them.
std::map<std::int64_t, std::int64_t> time_scales(Database& database) {
  std::map<std::int64_t, std::int64_t> scale_of_run;
  std::map<std::string, std::int64_t> scale_of_boot;
  Statement& runs =
      database.statement("SELECT run_id, boot_id, started_utc_ns - started_boottime_ns FROM run ORDER BY 1");
  while (runs.next()) {
    scale_of_run[runs.integer(0)] = scale_of_boot.try_emplace(runs.text(1), runs.integer(2)).first->second;
  }
  return scale_of_run;
}

// Of an item that was measured again only the last attempt that was accepted counts.
void drop_superseded(LargeArray<RawReading>& readings, std::size_t points) {
  const auto item_of = [](const RawReading& reading) {
    return 2 * static_cast<std::size_t>(*reading.point_index) + (reading.target == Target::Sample ? 0 : 1);
  };
  std::vector<std::int64_t> last(2 * points, 0);
  for (const RawReading& reading : readings) {
    if (reading.point_index) last[item_of(reading)] = std::max(last[item_of(reading)], reading.visit_id);
  }
  std::erase_if(readings, [&](const RawReading& reading) {
    return reading.point_index && reading.visit_id != last[item_of(reading)];
  });
}

bool has_reopened(Database& database, ScanId scan) {
  Statement& query = database.statement("SELECT EXISTS (SELECT 1 FROM reopening WHERE scan_id = ?)");
  return integer_or_none(query.bind(scan)).value_or(0) != 0;
}

// Of exposures that the plan states some may have been saturated: their frames are kept and not used. A probe for an
// exposure that nobody asked for is no part of its reading.
void mark_saturated(Database& database, ScanId scan, LargeArray<RawReading>& readings) {
  std::set<std::int64_t> owners;
  Statement& query = database.statement(
      "SELECT DISTINCT attempt_id FROM attempt JOIN reading USING (attempt_id) WHERE scan_id = ? AND used = 0 AND "
      "saturated > 0");
  query.bind(scan);
  while (query.next()) owners.insert(2 * query.integer(0));
  for (RawReading& reading : readings) reading.has_saturated = owners.contains(reading.visit_id);
}

/// A scan without its points and readings.
struct ScanHead {
  ScanReadings readings;
  bool states_exposures = false;  ///< the plan does
};

// Nothing where there is no such scan.
std::optional<ScanHead> read_head(Database& database, ScanId scan) {
  std::optional<ScanHead> head;
  Statement& query = database.statement(
      "SELECT isotropic, target_snr, max_time_ns, exposures_ns, block_ns, dark_every_ns, item_retries, on_item_error, "
      "on_restart, reference_every_ns, check_every_ns, drift_limit, drift_rounds, reference_mode, anchor_theta_i_deg, "
      "anchor_theta_r_deg, anchor_phi_r_deg, map_frames FROM scan WHERE scan_id = ?");
  query.bind(scan);
  while (query.next()) {
    const ScanPolicy policy = policy_from_row(query, 1);
    head.emplace();
    head->states_exposures = !policy.exposures.empty();
    head->readings.isotropic = query.integer(0) != 0;
    head->readings.reference_mode = static_cast<calibration::ReferenceMode>(policy.reference_mode);  // the same order
    if (policy.reference_every > Duration::zero()) head->readings.drift_limit = policy.drift_limit;
  }
  return head;
}

}  // namespace

Result<std::optional<ScanReadings>> read_scan_readings(Database& database, const std::string& path, ScanId scan,
                                                       const drivers::StageConfig& stage) {
  std::optional<ScanHead> head = read_head(database, scan);
  if (!head) return std::nullopt;
  ScanReadings& all = head->readings;
  auto points = read_parts<std::vector<PlannedPoint>>(
      path, parts_of(points_of(database, scan)),
      [&](Database& own, IdRange range) { return read_planned(own, scan, range); });
  if (!points) return failure(std::move(points).error());
  all.points = joined(std::move(*points));
  const RowContext context{.scan = scan, .stage = stage, .points = all.points, .scale_of_run = time_scales(database)};
  auto readings = read_parts<LargeArray<RawReading>>(
      path, reading_parts(database, scan),
      [&](Database& own, const ReadingPart& part) { return read_rows(own, part, context); });
  if (!readings) return failure(std::move(readings).error());
  all.readings = joined(std::move(*readings));
  if (has_reopened(database, scan)) drop_superseded(all.readings, all.points.size());
  const auto is_before = [](const RawReading& a, const RawReading& b) { return a.at < b.at; };
  if (!std::is_sorted(all.readings.begin(), all.readings.end(), is_before)) {
    std::stable_sort(all.readings.begin(), all.readings.end(), is_before);
  }
  if (head->states_exposures) mark_saturated(database, scan, all.readings);
  return std::move(all);
}

}  // namespace gonio::daemon
