#include "daemon/store/store_reader.h"

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>
#include <utility>

#include "daemon/store/database.h"
#include "daemon/store/found_calibrations.h"
#include "daemon/store/past_scans.h"
#include "daemon/store/schema.h"
#include "daemon/store/unfinished_scans.h"
#include "daemon/store/version_list.h"
#include "drivers/kinematics/kinematics.h"

namespace gonio::daemon {

namespace {

using calibration::RawFrame;
using calibration::RawReading;
using calibration::Target;
using stage::Axis;

Error no_such_scan(ScanId id) {
  return Error{.code = ErrorCode::NotFound,
               .device = "store",
               .tried = "read scan " + std::to_string(id),
               .seen = "there is no scan of this number"};
}

UtcTime utc_from(std::int64_t ns) {
  return UtcTime(Duration(ns));
}

// What one reading row is, before rows are put together.
struct ReadingRow {
  std::int64_t owner = 0;  // RawReading::visit_id
  bool is_visit = false;
  Target target = Target::Dark;
  std::optional<std::int32_t> point;
  double wavelength_nm = 0.0;
  std::int64_t id = 0;
  Instant at{};
  RawFrame frame;
};

// Where the point is known, the azimuths are given near its own; a dark's directions mean nothing.
Geometry geometry_from_counts(const Statement& row, int first, const drivers::StageConfig& stage,
                              const Geometry* planned) {
  stage::PerAxis<double> positions{};
  for (const Axis axis : stage::kAllAxes) {
    const std::size_t a = stage::index_of(axis);
    positions[a] = drivers::position_of(stage, axis, row.integer(first + static_cast<int>(a)));
  }
  if (planned == nullptr) return drivers::directions(stage.kinematics, positions);
  return drivers::directions_near(stage.kinematics, positions, *planned);
}

calibration::PowerReading power_from_row(const Statement& row, int first) {
  return {.mean_w = row.real(first),
          .standard_error_w = row.real(first + 1),
          .samples = static_cast<int>(row.integer(first + 2)),
          .averages = static_cast<int>(row.integer(first + 3)),
          .range_w = row.real(first + 4),
          .wavelength = nanometres(row.real(first + 5))};
}

// Columns as in the query of `readings`.
ReadingRow reading_from_row(const Statement& row, const drivers::StageConfig& stage,
                            const std::vector<calibration::PlannedPoint>& points,
                            const std::map<std::int64_t, std::int64_t>& scale_of_run) {
  ReadingRow reading;
  const bool is_visit = row.is_null(1);
  reading.owner = is_visit ? 2 * row.integer(2) + 1 : 2 * row.integer(1);
  reading.is_visit = is_visit;
  const bool is_dark = row.is_null(3);
  reading.target = is_dark ? Target::Dark : target_from_name(row.text(3)).value_or(Target::Sample);
  if (!is_dark) reading.point = static_cast<std::int32_t>(row.integer(4));
  if (!is_dark) reading.wavelength_nm = row.real(5);
  reading.id = row.integer(0);
  const auto scale = scale_of_run.find(row.integer(6));
  reading.at = Instant(Duration(row.integer(7) + (scale == scale_of_run.end() ? 0 : scale->second)));
  reading.frame.region = {.n = static_cast<std::uint32_t>(row.integer(8)),
                          .mean = row.real(9),
                          .m2 = row.real(10),
                          .m3 = row.real(11),
                          .m4 = row.real(12),
                          .saturated = static_cast<std::uint32_t>(row.integer(13))};
  reading.frame.exposure_s = in_seconds(Duration(row.integer(14)));
  reading.frame.gain_db = row.real(15);
  reading.frame.monitor_mean = row.real(16);
  reading.frame.monitor_se = row.real(17);
  reading.frame.detector_temperature_c = row.real(18);
  const Geometry* planned = is_dark ? nullptr : &points.at(static_cast<std::size_t>(*reading.point)).geometry;
  reading.frame.at_open = geometry_from_counts(row, 19, stage, planned);
  reading.frame.at_close = geometry_from_counts(row, 25, stage, planned);
  if (!row.is_null(31)) {
    reading.frame.reduced = calibration::ReducedMean{.n = static_cast<std::uint32_t>(row.integer(31)),
                                                     .mean_dn = row.real(32),
                                                     .u_noise_dn = row.real(33),
                                                     .u_maps_dn = row.real(34)};
  }
  if (!row.is_null(35)) reading.frame.power = power_from_row(row, 35);
  return reading;
}

// Frames of one attempt or visit at one exposure, or in one range, become one reading; its time is the mean of theirs.
class ReadingCollector {
 public:
  void add(const ReadingRow& row) {
    const Key key{row.owner, row.frame.exposure_s, row.frame.power ? row.frame.power->range_w : 0.0};
    auto [place, is_new] = place_.try_emplace(key, readings_.size());
    if (is_new) {
      readings_.push_back(RawReading{.id = row.id,
                                     .target = row.target,
                                     .point_index = row.is_visit ? std::nullopt : row.point,
                                     .visited_point = row.is_visit ? row.point : std::nullopt,
                                     .visit_id = row.owner,
                                     .wavelength = nanometres(row.wavelength_nm),
                                     .at = row.at});
    }
    RawReading& reading = readings_[place->second];
    reading.frames.push_back(row.frame);
    const auto n = static_cast<std::int64_t>(reading.frames.size());
    reading.at += (row.at - reading.at) / n;
  }

  std::vector<RawReading> take() {
    std::stable_sort(readings_.begin(), readings_.end(),
                     [](const RawReading& a, const RawReading& b) { return a.at < b.at; });
    return std::move(readings_);
  }

 private:
  using Key = std::tuple<std::int64_t, double, double>;
  std::map<Key, std::size_t> place_;
  std::vector<RawReading> readings_;
};

class SqliteStoreReader final : public StoreReader {
 public:
  explicit SqliteStoreReader(std::unique_ptr<Database> database) : database_(std::move(database)) {}

  Result<std::vector<ScanInfo>> scans(ScanId before, int at_most) override {
    return look([&] {
      std::vector<ScanId> ids;
      Statement& query =
          database_->statement("SELECT scan_id FROM scan WHERE scan_id < ? ORDER BY scan_id DESC LIMIT ?");
      query.bind(before == 0 ? std::numeric_limits<std::int64_t>::max() : before).bind(at_most);
      while (query.next()) ids.push_back(query.integer(0));
      std::vector<ScanInfo> infos;
      for (const ScanId id : ids) infos.push_back(read_scan(id));
      return infos;
    });
  }

  Result<ScanInfo> scan(ScanId id) override {
    auto info = look([&] { return read_scan(id); });
    if (info && info->id == 0) return failure(no_such_scan(id));
    return info;
  }

  Result<ScanTexts> texts(ScanId id) override {
    std::optional<ScanTexts> texts;
    Statement& query = database_
                           ->statement(
                               "SELECT plan_text, plan_file, r.text, i.text, plan_sha256, r.sha256, i.sha256 FROM scan "
                               "JOIN reference_standard r USING (reference_id) JOIN instrument i USING (instrument_id) "
                               "WHERE scan_id = ?")
                           .bind(id);
    while (query.next()) {
      texts = ScanTexts{.plan = query.text(0),
                        .plan_file = query.text(1),
                        .reference = query.text(2),
                        .instrument = query.text(3),
                        .plan_sha256 = query.text(4),
                        .reference_sha256 = query.text(5),
                        .instrument_sha256 = query.text(6)};
    }
    Statement& parts = database_->statement("SELECT name, text FROM plan_part WHERE scan_id = ?").bind(id);
    while (texts && parts.next()) texts->plan_parts.emplace(parts.text(0), parts.text(1));
    GONIO_TRY(database_->take_error());
    if (!texts) return failure(no_such_scan(id));
    return *texts;
  }

  Result<std::vector<PointInfo>> points(ScanId id, std::int32_t after, int at_most) override {
    return look([&] {
      std::vector<PointInfo> infos;
      for (const ScanPoint& point : read_points(*database_, id, after, at_most)) infos.push_back({.point = point});
      if (!infos.empty()) add_outcomes(id, infos);
      return infos;
    });
  }

  Result<calibration::ScanReadings> readings(ScanId id, const drivers::StageConfig& stage) override {
    auto found = look([&] {
      calibration::ScanReadings all;
      const ScanInfo info = read_scan(id);
      if (info.id == 0) return std::pair(false, std::move(all));
      all.isotropic = info.isotropic;
      all.reference_mode = static_cast<calibration::ReferenceMode>(info.policy.reference_mode);  // the same order
      if (info.policy.reference_every > Duration::zero()) all.drift_limit = info.policy.drift_limit;
      for (const ScanPoint& point : read_points(*database_, id, -1, std::numeric_limits<std::int64_t>::max())) {
        all.points.push_back({.index = point.index,
                              .geometry = point.geometry,
                              .wavelength = point.wavelength,
                              .is_blocked = point.blocked});
      }
      all.readings = collect_readings(id, stage, all.points);
      if (!info.policy.exposures.empty()) mark_saturated(id, all.readings);
      return std::pair(true, std::move(all));
    });
    if (!found) return failure(found.error());
    if (!found->first) return failure(no_such_scan(id));
    return std::move(found->second);
  }

  Result<std::vector<EventRecord>> events(std::int64_t after, int at_most, ScanId scan) override {
    std::vector<EventRecord> records;
    Statement& query = database_->statement(
        "SELECT number, kind, kind_version, coalesce(scan_id, 0), who, utc_ns, json FROM event "
        "WHERE number > ?1 AND (?2 = 0 OR scan_id = ?2) ORDER BY number LIMIT ?3");
    query.bind(after).bind(scan).bind(at_most);
    while (query.next()) {
      records.push_back(EventRecord{.number = query.integer(0),
                                    .kind = query.text(1),
                                    .kind_version = static_cast<int>(query.integer(2)),
                                    .scan = query.integer(3),
                                    .who = query.text(4),
                                    .utc = utc_from(query.integer(5)),
                                    .json = query.text(6)});
    }
    GONIO_TRY(database_->take_error());
    return records;
  }

  Result<std::int64_t> last_event() override {
    std::int64_t number = 0;
    Statement& query = database_->statement("SELECT coalesce(max(number), 0) FROM event");
    while (query.next()) number = query.integer(0);
    GONIO_TRY(database_->take_error());
    return number;
  }

  Result<TimeExperience> time_experience(const std::string& configuration_hash) override {
    return look([&] { return read_experience(*database_, configuration_hash); });
  }

  Result<BrdfInfo> brdf(ScanId id) override {
    auto info = look([&] { return read_brdf(id); });
    if (info && info->calibration == 0) {
      return failure(Error{.code = ErrorCode::NotFound,
                           .device = "store",
                           .tried = "read the BRDF of scan " + std::to_string(id),
                           .seen = "none was computed yet"});
    }
    return info;
  }

  Result<std::vector<FoundCalibration>> found_calibrations() override {
    return look([&] { return read_found_calibrations(*database_); });
  }

  Result<std::vector<UnfinishedScan>> unfinished(Instant now, UtcTime utc_now) override {
    return look([&] { return read_unfinished(*database_, now, utc_now); });
  }

 private:
  // One consistent look, whatever the writer commits meanwhile.
  template <class Read>
  auto look(Read read) -> Result<decltype(read())> {
    database_->statement("BEGIN").run();
    auto value = read();
    auto done = database_->take_error();
    database_->execute("COMMIT");
    auto ended = database_->take_error();
    if (!done) return failure(done.error());
    if (!ended) return failure(ended.error());
    return value;
  }

  ScanInfo read_scan(ScanId id) {
    ScanInfo info;
    Statement& query =
        database_
            ->statement(
                "SELECT s.scan_id, s.name, coalesce(c.name, ''), p.name, isotropic, state, outcome, who, serial, "
                "configuration_hash, submitted_utc_ns, changed_utc_ns, merged, blocked, items, target_snr, "
                "max_time_ns, exposures_ns, block_ns, dark_every_ns, item_retries, on_item_error, on_restart, "
                "reference_every_ns, check_every_ns, drift_limit, drift_rounds, reference_mode, anchor_theta_i_deg, "
                "anchor_theta_r_deg, anchor_phi_r_deg FROM scan "
                "s "
                "JOIN sample p USING (sample_id) JOIN reference_standard USING (reference_id) "
                "LEFT JOIN campaign c USING (campaign_id) WHERE s.scan_id = ?")
            .bind(id);
    while (query.next()) {
      info =
          ScanInfo{.id = query.integer(0),
                   .name = query.text(1),
                   .campaign = query.text(2),
                   .sample = query.text(3),
                   .isotropic = query.integer(4) != 0,
                   .state = scan_state_from_name(query.text(5)).value_or(ScanState::Failed),
                   .outcome = query.text(6),
                   .who = query.text(7),
                   .reference_serial = query.text(8),
                   .instrument_hash = query.text(9),
                   .policy = policy_from_row(query, 15),
                   .submitted = utc_from(query.integer(10)),
                   .changed = utc_from(query.integer(11)),
                   .counts = {.merged = query.integer(12), .blocked = query.integer(13), .items = query.integer(14)}};
    }
    if (info.id == 0) return info;
    add_counts(info);
    info.spent = read_time_spent(*database_, id);
    info.largest_drift = read_largest_drift(*database_, id);
    // Times as UTC counts them: a reader has no clock, and only differences between holds mean something.
    info.holds = read_holds(*database_, id, Instant{}, UtcTime{});
    info.turn = read_turn(*database_, id, Instant{}, UtcTime{});
    Statement& completing = database_->statement("SELECT max(scan_id) FROM scan_turn WHERE completes_scan_id = ?");
    completing.bind(id);
    while (completing.next()) info.completed_by = completing.integer(0);
    return info;
  }

  void add_counts(ScanInfo& info) {
    Statement& query = database_->statement(
        "SELECT (SELECT count(*) FROM point WHERE scan_id = ?1), "
        "(SELECT count(*) FROM decided_item WHERE scan_id = ?1 AND outcome = 'accepted'), "
        "(SELECT count(*) FROM decided_item WHERE scan_id = ?1 AND outcome = 'skipped'), "
        "(SELECT count(*) FROM attempt WHERE scan_id = ?1), (SELECT count(*) FROM visit WHERE scan_id = ?1), "
        "(SELECT count(*) FROM visit WHERE scan_id = ?1 AND kind = 'reference'), "
        "(SELECT count(*) FROM visit WHERE scan_id = ?1 AND kind = 'check'), "
        "(SELECT count(DISTINCT point_index) FROM reopening WHERE scan_id = ?1)");
    query.bind(info.id);
    while (query.next()) {
      info.counts.points = query.integer(0);
      info.counts.accepted = query.integer(1);
      info.counts.skipped = query.integer(2);
      info.counts.attempts = query.integer(3);
      info.counts.visits = query.integer(4);
      info.counts.reference_visits = query.integer(5);
      info.counts.check_visits = query.integer(6);
      info.counts.reopened = query.integer(7);
    }
  }

  void add_outcomes(ScanId id, std::vector<PointInfo>& infos) {
    const std::int32_t first = infos.front().point.index;
    const std::int32_t last = infos.back().point.index;
    Statement& items = database_->statement(
        "SELECT point_index, target, outcome FROM decided_item WHERE scan_id = ? AND point_index BETWEEN ? AND ?");
    items.bind(id).bind(first).bind(last);
    while (items.next()) {
      PointInfo& info = infos[static_cast<std::size_t>(items.integer(0) - first)];
      (items.text(1) == "sample" ? info.sample_outcome : info.reference_outcome) = items.text(2);
    }
    Statement& attempts = database_->statement(
        "SELECT point_index, count(*) FROM attempt WHERE scan_id = ? AND point_index BETWEEN ? AND ? GROUP BY 1");
    attempts.bind(id).bind(first).bind(last);
    while (attempts.next()) {
      infos[static_cast<std::size_t>(attempts.integer(0) - first)].attempts = static_cast<int>(attempts.integer(1));
    }
  }

  // One scale for readings of several boots: boot time within each, and UTC at each boot's first run between them.
  std::map<std::int64_t, std::int64_t> time_scales() {
    std::map<std::int64_t, std::int64_t> scale_of_run;
    std::map<std::string, std::int64_t> scale_of_boot;
    Statement& runs =
        database_->statement("SELECT run_id, boot_id, started_utc_ns - started_boottime_ns FROM run ORDER BY 1");
    while (runs.next()) {
      scale_of_run[runs.integer(0)] = scale_of_boot.try_emplace(runs.text(1), runs.integer(2)).first->second;
    }
    return scale_of_run;
  }

  std::vector<RawReading> collect_readings(ScanId id, const drivers::StageConfig& stage,
                                           const std::vector<calibration::PlannedPoint>& points) {
    const auto scales = time_scales();
    ReadingCollector collector;
    // Sorted by row: the order of the commits, and within one the order of the exposures.
    Statement& query = database_->statement(
        "SELECT reading_id, attempt_id, visit_id, target, point_index, wavelength_nm, run_id, t, region_n, mean_dn, "
        "m2_dn2, "
        "m3_dn3, m4_dn4, saturated, exposure_ns, gain_db, monitor_mean, monitor_se, detector_temperature_c, "
        "open_theta_i_counts, open_theta_r_counts, open_phi_r_counts, open_phi_i_counts, open_carriage_counts, "
        "open_filter_wheel_counts, close_theta_i_counts, close_theta_r_counts, close_phi_r_counts, close_phi_i_counts, "
        "close_carriage_counts, close_filter_wheel_counts, counted_n, reduced_dn, u_noise_dn, u_maps_dn, mean_w, "
        "standard_error_w, samples, averages, range_w, set_to_nm FROM ("
        "SELECT d.*, d.boottime_ns AS t, a.run_id, a.target, a.point_index, p.wavelength_nm FROM (SELECT attempt_id, "
        "round, max(round) OVER (PARTITION BY point_index, target) AS last_round FROM item WHERE scan_id = ?1 AND "
        "outcome = 'accepted') i "
        "JOIN attempt a USING (attempt_id) JOIN reading d USING (attempt_id) "
        "JOIN point p ON p.scan_id = a.scan_id AND p.point_index = a.point_index WHERE i.round = i.last_round "
        "UNION ALL SELECT d.*, d.boottime_ns, v.run_id, l.target, l.point_index, p.wavelength_nm FROM visit v "
        "LEFT JOIN visit_level l USING (visit_id) LEFT JOIN point p ON p.scan_id = l.scan_id AND p.point_index = "
        "l.point_index JOIN reading d USING (visit_id) WHERE v.scan_id = ?1) LEFT JOIN frame_reduction USING "
        "(reading_id) "
        "LEFT JOIN (SELECT reading_id AS of_reading, mean_w, "
        "standard_error_w, samples, averages, range_w, wavelength_nm AS set_to_nm FROM power_reading WHERE role = "
        "'detector') ON of_reading = reading_id WHERE used = 1 ORDER BY reading_id");
    query.bind(id);
    while (query.next()) collector.add(reading_from_row(query, stage, points, scales));
    return collector.take();
  }

  // Of exposures that the plan states some may have been saturated: their frames are kept and not used. A probe for an
  // exposure that nobody asked for is no part of its reading.
  void mark_saturated(ScanId id, std::vector<RawReading>& readings) {
    std::set<std::int64_t> owners;
    Statement& query = database_->statement(
        "SELECT DISTINCT attempt_id FROM attempt JOIN reading USING (attempt_id) WHERE scan_id = ? AND used = 0 AND "
        "saturated > 0");
    query.bind(id);
    while (query.next()) owners.insert(2 * query.integer(0));
    for (RawReading& reading : readings) reading.has_saturated = owners.contains(reading.visit_id);
  }

  BrdfInfo read_brdf(ScanId id) {
    BrdfInfo info;
    Statement& newest = database_->statement(
        "SELECT calibration_id, code_version, inputs_json, component_names_json, versions, sizes_only_json FROM "
        "calibration WHERE scan_id = ? "
        "ORDER BY calibration_id DESC LIMIT 1");
    newest.bind(id);
    while (newest.next()) {
      info.calibration = newest.integer(0);
      info.code_version = newest.text(1);
      info.inputs_json = newest.text(2);
      const auto names = nlohmann::json::parse(newest.text(3), nullptr, false);
      if (names.is_array()) info.component_names = names.get<std::vector<std::string>>();
      info.versions = version_list_from(newest.text(4));
      const auto sizes_only = nlohmann::json::parse(newest.text(5), nullptr, false);
      if (sizes_only.is_array()) info.sizes_only = sizes_only.get<std::vector<std::uint32_t>>();
    }
    Statement& query = database_->statement(
        "SELECT point_index, value_per_sr, u_random_per_sr, effective_dof, flags, theta_i_deg, phi_i_deg, theta_r_deg, "
        "phi_r_deg, sensitivities_per_sr FROM brdf WHERE calibration_id = ? ORDER BY point_index");
    query.bind(info.calibration);
    while (query.next()) {
      const auto sensitivities = query.doubles(9);
      const double dof = query.real(3);
      info.rows.push_back(BrdfRow{.point = static_cast<std::int32_t>(query.integer(0)),
                                  .value_per_sr = query.real(1),
                                  .u_random_per_sr = query.real(2),
                                  .effective_dof = dof == 0.0 ? std::numeric_limits<double>::infinity() : dof,
                                  .flags = static_cast<std::uint32_t>(query.integer(4)),
                                  .reported = {.theta_i = degrees(query.real(5)),
                                               .phi_i = degrees(query.real(6)),
                                               .theta_r = degrees(query.real(7)),
                                               .phi_r = degrees(query.real(8))},
                                  .sensitivities_per_sr = {sensitivities.begin(), sensitivities.end()}});
    }
    read_intervals(info);
    return info;
  }

  // Few rows have one; both lists ascend by point.
  void read_intervals(BrdfInfo& info) {
    Statement& query = database_->statement(
        "SELECT point_index, u_per_sr, below_per_sr, above_per_sr FROM brdf_interval WHERE calibration_id = ? ORDER BY "
        "point_index");
    query.bind(info.calibration);
    auto row = info.rows.begin();
    while (query.next()) {
      row = std::ranges::lower_bound(row, info.rows.end(), query.integer(0), {}, &BrdfRow::point);
      if (row == info.rows.end()) return;
      row->interval = {.u_per_sr = query.real(1), .below_per_sr = query.real(2), .above_per_sr = query.real(3)};
    }
  }

  std::unique_ptr<Database> database_;
};

}  // namespace

Result<std::unique_ptr<StoreReader>> StoreReader::open(const std::string& path) {
  auto database = Database::open(path, Database::Mode::Read);
  if (!database) return failure(database.error());
  GONIO_TRY(check_version(**database));
  return std::make_unique<SqliteStoreReader>(std::move(*database));
}

}  // namespace gonio::daemon
