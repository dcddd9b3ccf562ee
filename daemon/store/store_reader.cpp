#include "daemon/store/store_reader.h"

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/store/database.h"
#include "daemon/store/found_calibrations.h"
#include "daemon/store/past_scans.h"
#include "daemon/store/pixel_sum_rows.h"
#include "daemon/store/scan_readings.h"
#include "daemon/store/schema.h"
#include "daemon/store/unfinished_scans.h"
#include "daemon/store/version_list.h"

namespace gonio::daemon {

namespace {

Error no_such_scan(ScanId id) {
  return Error{.code = ErrorCode::NotFound,
               .device = "store",
               .tried = "read scan " + std::to_string(id),
               .seen = "there is no scan of this number"};
}

UtcTime utc_from(std::int64_t ns) {
  return UtcTime(Duration(ns));
}

class SqliteStoreReader final : public StoreReader {
 public:
  SqliteStoreReader(std::unique_ptr<Database> database, std::string path)
      : database_(std::move(database)), path_(std::move(path)) {}

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
                               "SELECT plan_text, plan_file, r.text, i.text, plan_sha256, r.sha256, i.sha256, "
                               "submitted_utc_ns FROM scan "
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
                        .instrument_sha256 = query.text(6),
                        .submitted = utc_from(query.integer(7))};
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
    auto found = look([&] { return read_scan_readings(*database_, path_, id, stage); });
    if (!found) return failure(found.error());
    if (!*found) return failure((*found).error());
    if (!**found) return failure(no_such_scan(id));
    return std::move(***found);
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

  Result<PixelStacks> pixel_stacks(ScanId id) override {
    auto stacks = look([&] { return read_pixel_stacks(*database_, id); });
    if (!stacks) return failure(stacks.error());
    return std::move(*stacks);
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
                "anchor_theta_r_deg, anchor_phi_r_deg, map_frames FROM scan "
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
  std::string path_;
};

}  // namespace

Result<std::unique_ptr<StoreReader>> StoreReader::open(const std::string& path) {
  auto database = Database::open(path, Database::Mode::Read);
  if (!database) return failure(database.error());
  GONIO_TRY(check_version(**database));
  return std::make_unique<SqliteStoreReader>(std::move(*database), path);
}

}  // namespace gonio::daemon
