-- A store as version 1 wrote it, with a scan under way.
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
INSERT INTO sample VALUES(1, 'plate 7');
INSERT INTO reference_standard VALUES(1, 'SRT-1', '# reference', 'aa');
INSERT INTO instrument VALUES(1, '# bench', 'bb', '0123');
INSERT INTO run VALUES(1, 'boot-0', '0.1.0', 42, 1700000000000000000, 1000000000);
INSERT INTO scan(scan_id, name, sample_id, isotropic, reference_id, instrument_id, configuration_hash, plan_text, plan_file,
  plan_sha256, planner_version, target_snr, max_time_ns, block_ns, dark_every_ns, item_retries, on_item_error, on_restart, asked,
  merged, blocked, items, state, finish_asked, outcome, who, run_id, submitted_utc_ns, submitted_boottime_ns, changed_utc_ns)
  VALUES(1, 'old scan', 1, 1, 1, 1, '0123', '[scan]', 'old.toml', 'cc', 1, 250.0, 4000000000, 900000000000, 300000000000, 2,
  'skip', 'resume', 2, 0, 0, 4, 'running', 0, '', 'uid:1000', 1, 1700000000000000000, 1000000000, 1700000000000000000);
INSERT INTO point(scan_id, point_index, rank, theta_i_deg, phi_i_deg, theta_r_deg, phi_r_deg, wavelength_nm, blocked)
  VALUES(1, 0, 1, 30.0, 0.0, 10.0, 90.0, 568.0, 0), (1, 1, 0, 30.0, 0.0, 20.0, 90.0, 568.0, 0);
PRAGMA user_version = 1;
