#include "daemon/store/schema.h"

#include <fmt/core.h>

#include <array>
#include <string>

namespace gonio::daemon {

namespace {

// Version 1. Outside units in the names. Times: utc_ns for people, boottime_ns with its run for intervals. What is text
// here and an enum in the program has the names of records.h. Raw rows are never updated: item, attempt, reading,
// visit, event.
constexpr const char* kVersion1 = R"sql(
CREATE TABLE campaign(
  campaign_id INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE
) STRICT;
CREATE TABLE sample(
  sample_id INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE
) STRICT;
CREATE TABLE reference_standard(
  reference_id INTEGER PRIMARY KEY,
  serial TEXT NOT NULL,
  text TEXT NOT NULL,
  sha256 TEXT NOT NULL,
  UNIQUE (serial, sha256)
) STRICT;
CREATE TABLE instrument(
  instrument_id INTEGER PRIMARY KEY,
  text TEXT NOT NULL,
  sha256 TEXT NOT NULL UNIQUE,
  configuration_hash TEXT NOT NULL
) STRICT;
CREATE TABLE run(
  run_id INTEGER PRIMARY KEY,
  boot_id TEXT NOT NULL,
  version TEXT NOT NULL,
  pid INTEGER NOT NULL,
  started_utc_ns INTEGER NOT NULL,
  started_boottime_ns INTEGER NOT NULL
) STRICT;
CREATE TABLE scan(
  scan_id INTEGER PRIMARY KEY AUTOINCREMENT,
  idempotency_key TEXT UNIQUE,
  name TEXT NOT NULL,
  campaign_id INTEGER REFERENCES campaign,
  sample_id INTEGER NOT NULL REFERENCES sample,
  isotropic INTEGER NOT NULL,
  reference_id INTEGER NOT NULL REFERENCES reference_standard,
  instrument_id INTEGER NOT NULL REFERENCES instrument,
  configuration_hash TEXT NOT NULL,
  plan_text TEXT NOT NULL,
  plan_file TEXT NOT NULL,
  plan_sha256 TEXT NOT NULL,
  planner_version INTEGER NOT NULL,
  target_snr REAL NOT NULL,
  max_time_ns INTEGER NOT NULL,
  block_ns INTEGER NOT NULL,
  dark_every_ns INTEGER NOT NULL,
  item_retries INTEGER NOT NULL,
  on_item_error TEXT NOT NULL,
  on_restart TEXT NOT NULL,
  asked INTEGER NOT NULL,
  merged INTEGER NOT NULL,
  blocked INTEGER NOT NULL,
  items INTEGER NOT NULL,
  state TEXT NOT NULL,
  finish_asked INTEGER NOT NULL,
  outcome TEXT NOT NULL,
  who TEXT NOT NULL,
  run_id INTEGER NOT NULL REFERENCES run,
  submitted_utc_ns INTEGER NOT NULL,
  submitted_boottime_ns INTEGER NOT NULL,
  changed_utc_ns INTEGER NOT NULL
) STRICT;
CREATE TABLE point(
  scan_id INTEGER NOT NULL REFERENCES scan,
  point_index INTEGER NOT NULL,
  rank INTEGER NOT NULL,
  theta_i_deg REAL NOT NULL,
  phi_i_deg REAL NOT NULL,
  theta_r_deg REAL NOT NULL,
  phi_r_deg REAL NOT NULL,
  wavelength_nm REAL NOT NULL,
  source_polarisation TEXT NOT NULL DEFAULT 'none',
  detector_polarisation TEXT NOT NULL DEFAULT 'none',
  x_mm REAL NOT NULL DEFAULT 0,
  y_mm REAL NOT NULL DEFAULT 0,
  blocked INTEGER NOT NULL,
  PRIMARY KEY (scan_id, point_index),
  UNIQUE (scan_id, rank)
) STRICT, WITHOUT ROWID;
CREATE TABLE attempt(
  attempt_id INTEGER PRIMARY KEY,
  scan_id INTEGER NOT NULL,
  point_index INTEGER NOT NULL,
  target TEXT NOT NULL CHECK (target IN ('sample', 'reference')),
  number INTEGER NOT NULL,
  outcome TEXT NOT NULL CHECK (outcome IN ('accepted', 'failed', 'dropped')),
  error_code TEXT NOT NULL,
  error TEXT NOT NULL,
  move_ns INTEGER NOT NULL,
  settle_ns INTEGER NOT NULL,
  expose_ns INTEGER NOT NULL,
  read_ns INTEGER NOT NULL,
  idle_ns INTEGER NOT NULL,
  run_id INTEGER NOT NULL REFERENCES run,
  started_boottime_ns INTEGER NOT NULL,
  boottime_ns INTEGER NOT NULL,
  utc_ns INTEGER NOT NULL,
  UNIQUE (scan_id, point_index, target, number),
  FOREIGN KEY (scan_id, point_index) REFERENCES point
) STRICT;
CREATE TABLE item(
  scan_id INTEGER NOT NULL,
  point_index INTEGER NOT NULL,
  target TEXT NOT NULL CHECK (target IN ('sample', 'reference')),
  outcome TEXT NOT NULL CHECK (outcome IN ('accepted', 'skipped')),
  attempt_id INTEGER UNIQUE REFERENCES attempt,
  who TEXT NOT NULL,
  reason TEXT NOT NULL,
  PRIMARY KEY (scan_id, point_index, target),
  FOREIGN KEY (scan_id, point_index) REFERENCES point,
  CHECK ((outcome = 'accepted') = (attempt_id IS NOT NULL))
) STRICT, WITHOUT ROWID;
CREATE TABLE visit(
  visit_id INTEGER PRIMARY KEY,
  scan_id INTEGER NOT NULL REFERENCES scan,
  kind TEXT NOT NULL CHECK (kind IN ('dark', 'reference', 'check')),
  after_attempt INTEGER NOT NULL,
  move_ns INTEGER NOT NULL,
  settle_ns INTEGER NOT NULL,
  expose_ns INTEGER NOT NULL,
  read_ns INTEGER NOT NULL,
  idle_ns INTEGER NOT NULL,
  run_id INTEGER NOT NULL REFERENCES run,
  started_boottime_ns INTEGER NOT NULL,
  boottime_ns INTEGER NOT NULL,
  utc_ns INTEGER NOT NULL
) STRICT;
CREATE INDEX visit_by_scan ON visit(scan_id);
CREATE TABLE reading(
  reading_id INTEGER PRIMARY KEY,
  attempt_id INTEGER REFERENCES attempt,
  visit_id INTEGER REFERENCES visit,
  sequence INTEGER NOT NULL,
  used INTEGER NOT NULL,
  region_n INTEGER NOT NULL,
  mean_dn REAL NOT NULL,
  m2_dn2 REAL NOT NULL,
  m3_dn3 REAL NOT NULL,
  m4_dn4 REAL NOT NULL,
  saturated INTEGER NOT NULL,
  exposure_ns INTEGER NOT NULL,
  gain_db REAL NOT NULL,
  camera_frame_id INTEGER NOT NULL,
  camera_time_ns INTEGER NOT NULL,
  camera_temperature_c REAL NOT NULL,
  gate_count INTEGER NOT NULL,
  open_theta_i_counts INTEGER NOT NULL,
  open_theta_r_counts INTEGER NOT NULL,
  open_phi_r_counts INTEGER NOT NULL,
  open_phi_i_counts INTEGER NOT NULL,
  open_carriage_counts INTEGER NOT NULL,
  open_filter_wheel_counts INTEGER NOT NULL,
  close_theta_i_counts INTEGER NOT NULL,
  close_theta_r_counts INTEGER NOT NULL,
  close_phi_r_counts INTEGER NOT NULL,
  close_phi_i_counts INTEGER NOT NULL,
  close_carriage_counts INTEGER NOT NULL,
  close_filter_wheel_counts INTEGER NOT NULL,
  monitor_mean REAL NOT NULL,
  monitor_se REAL NOT NULL,
  monitor_n INTEGER NOT NULL,
  lamp_temperature_c REAL NOT NULL,
  detector_temperature_c REAL NOT NULL,
  room_temperature_c REAL NOT NULL,
  humidity_percent REAL NOT NULL,
  boottime_ns INTEGER NOT NULL,
  utc_ns INTEGER NOT NULL,
  UNIQUE (attempt_id, sequence),
  UNIQUE (visit_id, sequence),
  CHECK ((attempt_id IS NULL) <> (visit_id IS NULL))
) STRICT;
CREATE TABLE hold(
  hold_id INTEGER PRIMARY KEY,
  scan_id INTEGER NOT NULL REFERENCES scan,
  name TEXT NOT NULL,
  owner TEXT NOT NULL,
  reason TEXT NOT NULL,
  run_id INTEGER NOT NULL REFERENCES run,
  since_boottime_ns INTEGER NOT NULL,
  since_utc_ns INTEGER NOT NULL,
  cleared_utc_ns INTEGER,
  cleared_by TEXT NOT NULL
) STRICT;
CREATE UNIQUE INDEX hold_in_force ON hold(scan_id, name) WHERE cleared_utc_ns IS NULL;
CREATE TABLE event(
  number INTEGER PRIMARY KEY,
  kind TEXT NOT NULL,
  kind_version INTEGER NOT NULL,
  scan_id INTEGER REFERENCES scan,
  who TEXT NOT NULL,
  run_id INTEGER NOT NULL REFERENCES run,
  boottime_ns INTEGER NOT NULL,
  utc_ns INTEGER NOT NULL,
  json TEXT NOT NULL
) STRICT;
CREATE INDEX event_by_scan ON event(scan_id);
CREATE TABLE calibration(
  calibration_id INTEGER PRIMARY KEY,
  scan_id INTEGER NOT NULL REFERENCES scan,
  code_version TEXT NOT NULL,
  inputs_json TEXT NOT NULL,
  component_names_json TEXT NOT NULL,
  utc_ns INTEGER NOT NULL
) STRICT;
CREATE INDEX calibration_by_scan ON calibration(scan_id);
CREATE TABLE brdf(
  calibration_id INTEGER NOT NULL REFERENCES calibration,
  scan_id INTEGER NOT NULL,
  point_index INTEGER NOT NULL,
  value_per_sr REAL NOT NULL,
  u_random_per_sr REAL NOT NULL,
  effective_dof REAL NOT NULL,
  flags INTEGER NOT NULL,
  theta_i_deg REAL NOT NULL,
  phi_i_deg REAL NOT NULL,
  theta_r_deg REAL NOT NULL,
  phi_r_deg REAL NOT NULL,
  sensitivities_per_sr BLOB NOT NULL,
  PRIMARY KEY (calibration_id, point_index),
  FOREIGN KEY (scan_id, point_index) REFERENCES point
) STRICT;
CREATE TABLE audit(
  audit_id INTEGER PRIMARY KEY,
  who TEXT NOT NULL,
  action TEXT NOT NULL,
  detail TEXT NOT NULL,
  utc_ns INTEGER NOT NULL
) STRICT;
)sql";

// Version 2: exposures that a plan states, as exposure_list.h writes them.
constexpr const char* kVersion2 = R"sql(
ALTER TABLE scan ADD COLUMN exposures_ns TEXT NOT NULL DEFAULT '';
)sql";

// Version 3: readings reduced by maps; cameras without a temperature. Until then such a camera's was stored as 0, which
// no camera at work has.
constexpr const char* kVersion3 = R"sql(
ALTER TABLE reading ADD COLUMN camera_temperature_known INTEGER NOT NULL DEFAULT 1;
UPDATE reading SET camera_temperature_known = 0 WHERE camera_temperature_c = 0;
CREATE TABLE frame_reduction(
  reading_id INTEGER PRIMARY KEY REFERENCES reading,
  maps_sha256 TEXT NOT NULL,
  counted_n INTEGER NOT NULL,
  reduced_dn REAL NOT NULL,
  u_noise_dn REAL NOT NULL,
  u_maps_dn REAL NOT NULL
) STRICT;
)sql";

// Version 4: what a radiometer said, as detector (the reading's one pixel is its part of the range) or as lamp monitor.
// A reading of an overload has no row.
constexpr const char* kVersion4 = R"sql(
CREATE TABLE power_reading(
  reading_id INTEGER NOT NULL REFERENCES reading,
  role TEXT NOT NULL CHECK (role IN ('detector', 'monitor')),
  mean_w REAL NOT NULL,
  standard_error_w REAL NOT NULL,
  samples INTEGER NOT NULL,
  averages INTEGER NOT NULL,
  range_w REAL NOT NULL,
  wavelength_nm REAL NOT NULL,
  started_boottime_ns INTEGER NOT NULL,
  ended_boottime_ns INTEGER NOT NULL,
  PRIMARY KEY (reading_id, role)
) STRICT, WITHOUT ROWID;
)sql";

// Version 5: the queue. A scan without a row has the ordinary turn: priority 0, as soon as it may.
constexpr const char* kVersion5 = R"sql(
CREATE TABLE scan_turn(
  scan_id INTEGER PRIMARY KEY REFERENCES scan,
  priority INTEGER NOT NULL,
  preempts INTEGER NOT NULL,
  start_utc_ns INTEGER,
  completes_scan_id INTEGER REFERENCES scan(scan_id)
) STRICT;
CREATE INDEX scan_turn_by_completed ON scan_turn(completes_scan_id);
)sql";

// Version 6: visits of the standard and of the sample. An item is decided once in each round; a row of `reopening`, of
// the visit that saw a drift, ends a round. What is in force is `decided_item`.
constexpr const char* kVersion6 = R"sql(
ALTER TABLE scan ADD COLUMN reference_every_ns INTEGER NOT NULL DEFAULT 0;
ALTER TABLE scan ADD COLUMN check_every_ns INTEGER NOT NULL DEFAULT 0;
ALTER TABLE scan ADD COLUMN drift_limit REAL NOT NULL DEFAULT 0.005;
ALTER TABLE scan ADD COLUMN drift_rounds INTEGER NOT NULL DEFAULT 2;
CREATE TABLE visit_level(
  visit_id INTEGER PRIMARY KEY REFERENCES visit,
  scan_id INTEGER NOT NULL,
  point_index INTEGER NOT NULL,
  target TEXT NOT NULL CHECK (target IN ('sample', 'reference')),
  level REAL NOT NULL,
  u_relative REAL NOT NULL,
  drift REAL,
  FOREIGN KEY (scan_id, point_index) REFERENCES point
) STRICT;
CREATE TABLE item_by_round(
  scan_id INTEGER NOT NULL,
  point_index INTEGER NOT NULL,
  target TEXT NOT NULL CHECK (target IN ('sample', 'reference')),
  round INTEGER NOT NULL CHECK (round > 0),
  outcome TEXT NOT NULL CHECK (outcome IN ('accepted', 'skipped')),
  attempt_id INTEGER UNIQUE REFERENCES attempt,
  who TEXT NOT NULL,
  reason TEXT NOT NULL,
  PRIMARY KEY (scan_id, point_index, target, round),
  FOREIGN KEY (scan_id, point_index) REFERENCES point,
  CHECK ((outcome = 'accepted') = (attempt_id IS NOT NULL))
) STRICT, WITHOUT ROWID;
INSERT INTO item_by_round SELECT scan_id, point_index, target, 1, outcome, attempt_id, who, reason FROM item;
DROP TABLE item;
ALTER TABLE item_by_round RENAME TO item;
CREATE TABLE reopening(
  scan_id INTEGER NOT NULL,
  point_index INTEGER NOT NULL,
  target TEXT NOT NULL,
  round INTEGER NOT NULL,
  visit_id INTEGER NOT NULL REFERENCES visit,
  PRIMARY KEY (scan_id, point_index, target, round),
  FOREIGN KEY (scan_id, point_index, target, round) REFERENCES item
) STRICT, WITHOUT ROWID;
CREATE VIEW decided_item AS SELECT i.* FROM item i WHERE NOT EXISTS (SELECT 1 FROM reopening r WHERE
  r.scan_id = i.scan_id AND r.point_index = i.point_index AND r.target = i.target AND r.round = i.round);
)sql";

// Version 7: what idle time waited for. The rest of idle_ns is the daemon's own; of older rows nobody told it apart.
constexpr const char* kVersion7 = R"sql(
ALTER TABLE attempt ADD COLUMN idle_commit_ns INTEGER NOT NULL DEFAULT 0;
ALTER TABLE attempt ADD COLUMN idle_wire_ns INTEGER NOT NULL DEFAULT 0;
ALTER TABLE attempt ADD COLUMN idle_device_ns INTEGER NOT NULL DEFAULT 0;
ALTER TABLE attempt ADD COLUMN idle_hold_ns INTEGER NOT NULL DEFAULT 0;
ALTER TABLE visit ADD COLUMN idle_commit_ns INTEGER NOT NULL DEFAULT 0;
ALTER TABLE visit ADD COLUMN idle_wire_ns INTEGER NOT NULL DEFAULT 0;
ALTER TABLE visit ADD COLUMN idle_device_ns INTEGER NOT NULL DEFAULT 0;
ALTER TABLE visit ADD COLUMN idle_hold_ns INTEGER NOT NULL DEFAULT 0;
)sql";

// Version 8: the files that a plan names, and points that are measured several times.
constexpr const char* kVersion8 = R"sql(
CREATE TABLE plan_part(
  scan_id INTEGER NOT NULL REFERENCES scan,
  name TEXT NOT NULL,
  text TEXT NOT NULL,
  PRIMARY KEY (scan_id, name)
) STRICT, WITHOUT ROWID;
ALTER TABLE point ADD COLUMN repeat INTEGER NOT NULL DEFAULT 1;
)sql";

// Version 9: what calibration jobs found, each a version for good; which of them counts, as a history; and by which
// ones a BRDF was computed (numbers separated by blanks, empty: by instrument.toml alone).
constexpr const char* kVersion9 = R"sql(
CREATE TABLE found_calibration(
  version INTEGER PRIMARY KEY AUTOINCREMENT,
  scan_id INTEGER NOT NULL REFERENCES scan,
  job TEXT NOT NULL,
  code_version TEXT NOT NULL,
  inputs_json TEXT NOT NULL,
  covariance BLOB NOT NULL,
  note TEXT NOT NULL,
  utc_ns INTEGER NOT NULL
) STRICT;
CREATE INDEX found_calibration_by_scan ON found_calibration(scan_id);
CREATE TABLE found_value(
  version INTEGER NOT NULL REFERENCES found_calibration,
  place INTEGER NOT NULL,
  name TEXT NOT NULL,
  unit TEXT NOT NULL,
  value REAL NOT NULL,
  PRIMARY KEY (version, place)
) STRICT, WITHOUT ROWID;
CREATE TABLE calibration_use(
  use_id INTEGER PRIMARY KEY,
  version INTEGER NOT NULL REFERENCES found_calibration,
  in_use INTEGER NOT NULL,
  who TEXT NOT NULL,
  reason TEXT NOT NULL,
  utc_ns INTEGER NOT NULL
) STRICT;
CREATE INDEX calibration_use_by_version ON calibration_use(version);
ALTER TABLE calibration ADD COLUMN versions TEXT NOT NULL DEFAULT '';
)sql";

// Version 10: what a scan was predicted to take, and what past scans had taught the prediction: they are compared.
constexpr const char* kVersion10 = R"sql(
CREATE TABLE prediction(
  scan_id INTEGER PRIMARY KEY REFERENCES scan,
  motion_ns INTEGER NOT NULL,
  expose_ns INTEGER NOT NULL,
  beyond_ns INTEGER NOT NULL,
  u_s REAL NOT NULL,
  scans INTEGER NOT NULL,
  motion_ratio REAL NOT NULL,
  u_motion_ratio REAL NOT NULL,
  beyond_item_s REAL NOT NULL,
  u_beyond_item_s REAL NOT NULL
) STRICT;
)sql";

// Version 11: what sample readings are compared with. The anchor counts in its mode only.
constexpr const char* kVersion11 = R"sql(
ALTER TABLE scan ADD COLUMN reference_mode TEXT NOT NULL DEFAULT 'same-geometry';
ALTER TABLE scan ADD COLUMN anchor_theta_i_deg REAL NOT NULL DEFAULT 0.0;
ALTER TABLE scan ADD COLUMN anchor_theta_r_deg REAL NOT NULL DEFAULT 45.0;
ALTER TABLE scan ADD COLUMN anchor_phi_r_deg REAL NOT NULL DEFAULT 0.0;
)sql";

// Version 12: components whose terms are sizes without a known sign (until then told by their names), and the intervals
// of values whose k is not that of their degrees of freedom.
constexpr const char* kVersion12 = R"sql(
ALTER TABLE calibration ADD COLUMN sizes_only_json TEXT NOT NULL DEFAULT '[]';
UPDATE calibration SET sizes_only_json = (SELECT json_group_array(key) FROM json_each(component_names_json) WHERE
  value LIKE '%unresolved%' OR value LIKE '%lamp after%' OR value LIKE '%drift%');
CREATE TABLE brdf_interval(
  calibration_id INTEGER NOT NULL REFERENCES calibration,
  point_index INTEGER NOT NULL,
  u_per_sr REAL NOT NULL,
  below_per_sr REAL NOT NULL,
  above_per_sr REAL NOT NULL,
  PRIMARY KEY (calibration_id, point_index),
  FOREIGN KEY (calibration_id, point_index) REFERENCES brdf
) STRICT, WITHOUT ROWID;
)sql";

// Version 13: sums of frames, pixel by pixel, of the attempts and visits of jobs that make maps; sums and squares are
// float64, exact whole numbers of DN and DN^2.
constexpr const char* kVersion13 = R"sql(
ALTER TABLE scan ADD COLUMN map_frames INTEGER NOT NULL DEFAULT 0;
CREATE TABLE pixel_sum(
  pixel_sum_id INTEGER PRIMARY KEY,
  attempt_id INTEGER REFERENCES attempt,
  visit_id INTEGER REFERENCES visit,
  exposure_ns INTEGER NOT NULL,
  gain_db REAL NOT NULL,
  frames INTEGER NOT NULL,
  width_px INTEGER NOT NULL,
  height_px INTEGER NOT NULL,
  left_px INTEGER NOT NULL,
  top_px INTEGER NOT NULL,
  columns_px INTEGER NOT NULL,
  rows_px INTEGER NOT NULL,
  sums_dn BLOB NOT NULL,
  squares_dn2 BLOB NOT NULL,
  CHECK ((attempt_id IS NULL) <> (visit_id IS NULL))
) STRICT;
CREATE INDEX pixel_sum_by_attempt ON pixel_sum(attempt_id);
CREATE INDEX pixel_sum_by_visit ON pixel_sum(visit_id);
)sql";

constexpr std::array<const char*, kSchemaVersion> kMigrations{kVersion1,  kVersion2,  kVersion3, kVersion4, kVersion5,
                                                              kVersion6,  kVersion7,  kVersion8, kVersion9, kVersion10,
                                                              kVersion11, kVersion12, kVersion13};

int version_of(Database& database) {
  Statement& query = database.statement("PRAGMA user_version");
  int version = 0;
  while (query.next()) version = static_cast<int>(query.integer(0));
  return version;
}

Error too_new(int version) {
  return Error{.code = ErrorCode::StoreTooNew,
               .device = "store",
               .tried = "open the store",
               .seen = fmt::format("schema version {}", version),
               .limit = fmt::format("at most {}", kSchemaVersion)};
}

}  // namespace

Result<void> migrate(Database& database) {
  const int version = version_of(database);
  GONIO_TRY(database.take_error());
  if (version > kSchemaVersion) return failure(too_new(version));
  for (int step = version; step < kSchemaVersion; ++step) {
    const std::string set_version = fmt::format("PRAGMA user_version = {}", step + 1);
    database.execute("BEGIN IMMEDIATE");
    database.execute(kMigrations[static_cast<std::size_t>(step)]);
    database.execute(set_version.c_str());
    database.execute("COMMIT");
    auto done = database.take_error();
    if (done) continue;
    database.execute("ROLLBACK");
    (void)database.take_error();  // nothing to roll back when BEGIN was what failed
    return done;
  }
  return {};
}

Result<void> check_version(Database& database) {
  const int version = version_of(database);
  GONIO_TRY(database.take_error());
  if (version > kSchemaVersion) return failure(too_new(version));
  if (version == kSchemaVersion) return {};
  return failure(Error{.code = ErrorCode::StoreFailed,
                       .device = "store",
                       .tried = "read the store",
                       .seen = fmt::format("schema version {}", version),
                       .limit = fmt::format("version {}: start goniod on it once", kSchemaVersion)});
}

}  // namespace gonio::daemon
