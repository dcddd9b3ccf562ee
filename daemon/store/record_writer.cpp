#include "daemon/store/record_writer.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "daemon/config/configuration_hash.h"
#include "daemon/store/exposure_list.h"
#include "daemon/store/policy_names.h"
#include "daemon/store/version_list.h"

namespace gonio::daemon {

namespace {

constexpr std::array<std::string_view, 3> kOutcomeNames{"accepted", "failed", "dropped"};

std::string_view outcome_name(AttemptOutcome outcome) {
  return kOutcomeNames[static_cast<std::size_t>(outcome)];
}

std::int64_t single_integer(Statement& query) {
  std::int64_t value = 0;
  while (query.next()) value = query.integer(0);
  return value;
}

}  // namespace

std::int64_t RecordWriter::id_of_sample(const std::string& name) {
  database_.statement("INSERT INTO sample(name) VALUES (?) ON CONFLICT(name) DO NOTHING").bind(name).run();
  return single_integer(database_.statement("SELECT sample_id FROM sample WHERE name = ?").bind(name));
}

std::int64_t RecordWriter::id_of_campaign(const std::string& name) {
  database_.statement("INSERT INTO campaign(name) VALUES (?) ON CONFLICT(name) DO NOTHING").bind(name).run();
  return single_integer(database_.statement("SELECT campaign_id FROM campaign WHERE name = ?").bind(name));
}

std::int64_t RecordWriter::id_of_reference(const NewScan& scan) {
  const std::string hash = sha256_hex(scan.reference_text);
  database_.statement("INSERT INTO reference_standard(serial, text, sha256) VALUES (?,?,?) ON CONFLICT DO NOTHING")
      .bind(scan.reference_serial)
      .bind(scan.reference_text)
      .bind(hash)
      .run();
  return single_integer(
      database_.statement("SELECT reference_id FROM reference_standard WHERE serial = ? AND sha256 = ?")
          .bind(scan.reference_serial)
          .bind(hash));
}

std::int64_t RecordWriter::id_of_instrument(const NewScan& scan) {
  const std::string hash = sha256_hex(scan.instrument_text);
  database_.statement("INSERT INTO instrument(text, sha256, configuration_hash) VALUES (?,?,?) ON CONFLICT DO NOTHING")
      .bind(scan.instrument_text)
      .bind(hash)
      .bind(scan.instrument_hash)
      .run();
  return single_integer(database_.statement("SELECT instrument_id FROM instrument WHERE sha256 = ?").bind(hash));
}

void RecordWriter::operator()(const NewScan& scan) {
  const std::int64_t sample = id_of_sample(scan.sample);
  const std::int64_t campaign = scan.campaign.empty() ? 0 : id_of_campaign(scan.campaign);
  const std::int64_t reference = id_of_reference(scan);
  const std::int64_t instrument = id_of_instrument(scan);
  Statement& insert = database_.statement(
      "INSERT INTO scan(idempotency_key, name, campaign_id, sample_id, isotropic, reference_id, instrument_id, "
      "configuration_hash, plan_text, plan_file, plan_sha256, planner_version, target_snr, max_time_ns, exposures_ns, "
      "block_ns, "
      "dark_every_ns, item_retries, on_item_error, on_restart, reference_every_ns, check_every_ns, drift_limit, "
      "drift_rounds, reference_mode, anchor_theta_i_deg, anchor_theta_r_deg, anchor_phi_r_deg, asked, merged, blocked, "
      "map_frames, items, state, finish_asked, "
      "outcome, who, run_id, submitted_utc_ns, submitted_boottime_ns, changed_utc_ns) "
      "VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,'queued',0,'',?,?,?,?,?)");
  scan.idempotency_key.empty() ? insert.bind_null() : insert.bind(scan.idempotency_key);
  insert.bind(scan.name);
  campaign == 0 ? insert.bind_null() : insert.bind(campaign);
  insert.bind(sample).bind(scan.isotropic).bind(reference).bind(instrument).bind(scan.instrument_hash);
  insert.bind(scan.plan_text).bind(scan.plan_file).bind(sha256_hex(scan.plan_text)).bind(scan.planned.planner_version);
  insert.bind(scan.policy.target_snr).bind(scan.policy.max_time.count());
  insert.bind(exposure_list_text(scan.policy.exposures)).bind(scan.policy.block.count());
  insert.bind(scan.policy.dark_every.count()).bind(scan.policy.item_retries);
  insert.bind(kOnItemErrorNames[static_cast<std::size_t>(scan.policy.on_item_error)]);
  insert.bind(kOnRestartNames[static_cast<std::size_t>(scan.policy.on_restart)]);
  insert.bind(scan.policy.reference_every.count()).bind(scan.policy.check_every.count());
  insert.bind(scan.policy.drift_limit).bind(scan.policy.drift_rounds);
  insert.bind(kReferenceModeNames[static_cast<std::size_t>(scan.policy.reference_mode)]);
  insert.bind(in_degrees(scan.policy.anchor.theta_i)).bind(in_degrees(scan.policy.anchor.theta_r));
  insert.bind(in_degrees(scan.policy.anchor.phi_r));
  insert.bind(scan.planned.asked).bind(scan.planned.merged).bind(scan.planned.blocked);
  insert.bind(scan.policy.map_frames).bind(scan.planned.items);
  insert.bind(scan.who).bind(time_.run).bind(time_.utc_ns).bind(time_.boottime_ns).bind(time_.utc_ns).run();
  new_scan_ = database_.last_id();
  write_plan_parts(scan.plan_parts);
  write_points(scan.planned.points);
  write_prediction(scan.planned);
  write_turn(new_scan_, scan.turn);
}

void RecordWriter::write_plan_parts(const std::map<std::string, std::string>& parts) {
  Statement& insert = database_.statement("INSERT INTO plan_part(scan_id, name, text) VALUES (?,?,?)");
  for (const auto& [name, text] : parts) insert.bind(new_scan_).bind(name).bind(text).run();
}

// Of a scan that completes another nothing was predicted.
void RecordWriter::write_prediction(const PlannedScan& planned) {
  const TimeParts& time = planned.estimate;
  if (time.total() == Duration::zero()) return;
  const TimeExperience& experience = planned.experience;
  database_.statement("INSERT INTO prediction VALUES (?,?,?,?,?,?,?,?,?,?)")
      .bind(new_scan_)
      .bind((time.move + time.settle).count())
      .bind(time.expose.count())
      .bind(time.read.count())
      .bind(planned.u_estimate_s)
      .bind(experience.scans)
      .bind(experience.motion.value)
      .bind(experience.motion.u)
      .bind(experience.beyond_s.value)
      .bind(experience.beyond_s.u)
      .run();
}

void RecordWriter::write_points(const std::vector<ScanPoint>& points) {
  Statement& insert = database_.statement(
      "INSERT INTO point(scan_id, point_index, rank, theta_i_deg, phi_i_deg, theta_r_deg, phi_r_deg, wavelength_nm, "
      "blocked, repeat) VALUES (?,?,?,?,?,?,?,?,?,?)");
  for (const ScanPoint& point : points) {
    insert.bind(new_scan_).bind(point.index).bind(point.rank);
    insert.bind(in_degrees(point.geometry.theta_i)).bind(in_degrees(point.geometry.phi_i));
    insert.bind(in_degrees(point.geometry.theta_r)).bind(in_degrees(point.geometry.phi_r));
    insert.bind(in_nanometres(point.wavelength)).bind(point.blocked).bind(point.repeat).run();
  }
}

void RecordWriter::operator()(const ScanTransition& transition) {
  // A state that is not the one expected means a second writer or a lost transition: the transaction fails, nothing is
  // guessed.
  Statement& update = database_.statement(
      "UPDATE scan SET state = ?, finish_asked = ?, outcome = ?, changed_utc_ns = ? WHERE scan_id = ? AND state = ? "
      "RETURNING scan_id");
  update.bind(scan_state_name(transition.to)).bind(transition.finish_asked);
  update.bind(is_over(transition.to) ? transition.reason : std::string()).bind(time_.utc_ns);
  update.bind(transition.scan == 0 ? new_scan_ : transition.scan).bind(scan_state_name(transition.from));
  if (single_integer(update) != 0) return;
  database_.fail(Error{.code = ErrorCode::StoreFailed,
                       .device = "store",
                       .tried = "change the state of scan " + std::to_string(transition.scan) + " to " +
                                std::string(scan_state_name(transition.to)),
                       .seen = "it is not in state " + std::string(scan_state_name(transition.from))});
}

void RecordWriter::operator()(const AddHold& add) {
  database_
      .statement(
          "INSERT INTO hold(scan_id, name, owner, reason, run_id, since_boottime_ns, since_utc_ns, cleared_by) "
          "VALUES (?,?,?,?,?,?,?,'') ON CONFLICT DO NOTHING")
      .bind(add.scan)
      .bind(hold_name(add.hold.name))
      .bind(add.hold.owner)
      .bind(add.hold.reason)
      .bind(time_.run)
      .bind(time_.boottime_ns)
      .bind(time_.utc_ns)
      .run();
}

void RecordWriter::bind_time_parts(Statement& statement, const TimeParts& time) {
  statement.bind(time.move.count()).bind(time.settle.count()).bind(time.expose.count());
  statement.bind(time.read.count()).bind(time.idle.total().count()).bind(time.idle.commit.count());
  statement.bind(time.idle.wire.count()).bind(time.idle.device.count()).bind(time.idle.hold.count());
}

void RecordWriter::operator()(const NewAttempt& attempt) {
  const std::string_view target = target_name(attempt.item.target);
  const std::int64_t number = 1 + single_integer(database_
                                                     .statement("SELECT max(number) FROM attempt WHERE scan_id = ? "
                                                                "AND point_index = ? AND target = ?")
                                                     .bind(attempt.scan)
                                                     .bind(attempt.item.point)
                                                     .bind(target));
  Statement& insert = database_.statement(
      "INSERT INTO attempt(scan_id, point_index, target, number, outcome, error_code, error, move_ns, settle_ns, "
      "expose_ns, read_ns, idle_ns, idle_commit_ns, idle_wire_ns, idle_device_ns, idle_hold_ns, run_id, "
      "started_boottime_ns, boottime_ns, utc_ns) VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  insert.bind(attempt.scan).bind(attempt.item.point).bind(target).bind(number).bind(outcome_name(attempt.outcome));
  insert.bind(attempt.error ? traits(attempt.error->code).name : std::string_view());
  insert.bind(attempt.error ? describe(*attempt.error) : std::string());
  bind_time_parts(insert, attempt.time);
  insert.bind(time_.run).bind(attempt.started.time_since_epoch().count()).bind(time_.boottime_ns).bind(time_.utc_ns);
  insert.run();
  const std::int64_t id = database_.last_id();
  std::int64_t sequence = 0;
  for (const ReadingRecord& reading : attempt.readings) write_reading(reading, id, 0, ++sequence);
  for (const PixelSumRecord& sums : attempt.pixel_sums) write_pixel_sums(*sums, id, 0);
  if (attempt.outcome == AttemptOutcome::Accepted) write_item(attempt.scan, attempt.item, id, "", "");
}

void RecordWriter::write_item(ScanId scan, const ItemKey& item, std::int64_t attempt, const std::string& who,
                              const std::string& reason) {
  // Without ON CONFLICT: a second decision of an item in one round fails the whole transaction.
  Statement& insert = database_.statement(
      "INSERT INTO item(scan_id, point_index, target, outcome, attempt_id, who, reason, round) "
      "VALUES (?1,?2,?3,?4,?5,?6,?7,(SELECT count(*) + 1 FROM reopening WHERE scan_id = ?1 AND point_index = ?2 AND "
      "target = ?3))");
  insert.bind(scan).bind(item.point).bind(target_name(item.target)).bind(attempt == 0 ? "skipped" : "accepted");
  attempt == 0 ? insert.bind_null() : insert.bind(attempt);
  insert.bind(who).bind(reason).run();
}

void RecordWriter::operator()(const SkipItem& skip) {
  write_item(skip.scan, skip.item, 0, skip.who, skip.reason);
}

void RecordWriter::operator()(const NewVisit& visit) {
  Statement& insert = database_.statement(
      "INSERT INTO visit(scan_id, kind, after_attempt, move_ns, settle_ns, expose_ns, read_ns, idle_ns, "
      "idle_commit_ns, idle_wire_ns, idle_device_ns, idle_hold_ns, run_id, started_boottime_ns, boottime_ns, utc_ns) "
      "VALUES (?,?,(SELECT coalesce(max(attempt_id), 0) FROM attempt),?,?,?,?,?,?,?,?,?,?,?,?,?)");
  insert.bind(visit.scan).bind(visit_kind_name(visit.kind));
  bind_time_parts(insert, visit.time);
  insert.bind(time_.run).bind(visit.started.time_since_epoch().count()).bind(time_.boottime_ns).bind(time_.utc_ns);
  insert.run();
  const std::int64_t id = database_.last_id();
  std::int64_t sequence = 0;
  for (const ReadingRecord& reading : visit.readings) write_reading(reading, 0, id, ++sequence);
  for (const PixelSumRecord& sums : visit.pixel_sums) write_pixel_sums(*sums, 0, id);
  if (visit.level) write_level(visit, id);
  for (const ItemKey& item : visit.reopened) reopen(visit.scan, item, id);
}

void RecordWriter::write_level(const NewVisit& visit, std::int64_t id) {
  Statement& insert = database_.statement("INSERT INTO visit_level VALUES (?,?,?,?,?,?,?)");
  insert.bind(id).bind(visit.scan).bind(visit.level->point);
  insert.bind(visit.kind == VisitKind::Reference ? "reference" : "sample");
  insert.bind(visit.level->level).bind(visit.level->u_relative);
  visit.level->drift ? insert.bind(*visit.level->drift) : insert.bind_null();
  insert.run();
}

void RecordWriter::reopen(ScanId scan, const ItemKey& item, std::int64_t visit) {
  Statement& insert = database_.statement(
      "INSERT INTO reopening SELECT scan_id, point_index, target, round, ? FROM decided_item WHERE scan_id = ? AND "
      "point_index = ? AND target = ? AND outcome = 'accepted' RETURNING round");
  insert.bind(visit).bind(scan).bind(item.point).bind(target_name(item.target));
  if (single_integer(insert) != 0) return;
  database_.fail(Error{.code = ErrorCode::StoreFailed,
                       .device = "store",
                       .tried = "open the " + std::string(target_name(item.target)) + " item of point " +
                                std::to_string(item.point) + " of scan " + std::to_string(scan) + " again",
                       .seen = "it is not accepted in its present round"});
}

void RecordWriter::write_reading(const ReadingRecord& reading, std::int64_t attempt, std::int64_t visit,
                                 std::int64_t sequence) {
  Statement& insert = database_.statement(
      "INSERT INTO reading VALUES (NULL,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  attempt == 0 ? insert.bind_null() : insert.bind(attempt);
  visit == 0 ? insert.bind_null() : insert.bind(visit);
  insert.bind(sequence).bind(reading.used);
  insert.bind(reading.region.n).bind(reading.region.mean).bind(reading.region.m2).bind(reading.region.m3);
  insert.bind(reading.region.m4).bind(reading.region.saturated);
  insert.bind(reading.settings.exposure.count()).bind(reading.settings.gain_db);
  insert.bind(static_cast<std::int64_t>(reading.camera_frame_id));
  insert.bind(static_cast<std::int64_t>(reading.camera_time_ns)).bind(reading.camera_temperature_c.value_or(0.0));
  insert.bind(reading.gate_count);
  for (const std::int32_t counts : reading.open_counts) insert.bind(counts);
  for (const std::int32_t counts : reading.close_counts) insert.bind(counts);
  insert.bind(reading.monitor_mean).bind(reading.monitor_se).bind(reading.monitor_samples);
  insert.bind(reading.lamp_temperature_c).bind(reading.detector_temperature_c);
  insert.bind(reading.room_temperature_c).bind(reading.humidity_percent);
  insert.bind(reading.at.time_since_epoch().count()).bind(time_.utc_of(reading.at));
  insert.bind(reading.camera_temperature_c.has_value()).run();
  const std::int64_t id = database_.last_id();
  if (reading.reduced) write_reduction(*reading.reduced, reading.maps_version, id);
  if (reading.power) write_power(id, "detector", *reading.power);
  if (reading.monitor_power) write_power(id, "monitor", *reading.monitor_power);
}

void RecordWriter::write_reduction(const calibration::ReducedMean& reduced, const std::string& maps_version,
                                   std::int64_t reading) {
  database_.statement("INSERT INTO frame_reduction VALUES (?,?,?,?,?,?)")
      .bind(reading)
      .bind(maps_version)
      .bind(reduced.n)
      .bind(reduced.mean_dn)
      .bind(reduced.u_noise_dn)
      .bind(reduced.u_maps_dn)
      .run();
}

void RecordWriter::write_power(std::int64_t reading, const char* role, const PowerRecord& power) {
  const calibration::PowerReading& p = power.reading;
  database_.statement("INSERT INTO power_reading VALUES (?,?,?,?,?,?,?,?,?,?)")
      .bind(reading)
      .bind(role)
      .bind(p.mean_w)
      .bind(p.standard_error_w)
      .bind(p.samples)
      .bind(p.averages)
      .bind(p.range_w)
      .bind(in_nanometres(p.wavelength))
      .bind(power.started.time_since_epoch().count())
      .bind(power.ended.time_since_epoch().count())
      .run();
}

void RecordWriter::operator()(const NewBrdf& brdf) {
  database_
      .statement(
          "INSERT INTO calibration(scan_id, code_version, inputs_json, component_names_json, utc_ns, versions, "
          "sizes_only_json) VALUES (?,?,?,?,?,?,?)")
      .bind(brdf.scan)
      .bind(brdf.code_version)
      .bind(brdf.inputs_json)
      .bind(nlohmann::json(brdf.component_names).dump())
      .bind(time_.utc_ns)
      .bind(version_list_text(brdf.versions))
      .bind(nlohmann::json(brdf.sizes_only).dump())
      .run();
  const std::int64_t calibration = database_.last_id();
  Statement& insert = database_.statement("INSERT INTO brdf VALUES (?,?,?,?,?,?,?,?,?,?,?,?)");
  for (const BrdfRow& row : brdf.rows) {
    insert.bind(calibration).bind(brdf.scan).bind(row.point).bind(row.value_per_sr).bind(row.u_random_per_sr);
    insert.bind(std::isinf(row.effective_dof) ? 0.0 : row.effective_dof).bind(row.flags);
    insert.bind(in_degrees(row.reported.theta_i)).bind(in_degrees(row.reported.phi_i));
    insert.bind(in_degrees(row.reported.theta_r)).bind(in_degrees(row.reported.phi_r));
    insert.bind_blob(row.sensitivities_per_sr).run();
  }
  Statement& insert_interval = database_.statement("INSERT INTO brdf_interval VALUES (?,?,?,?,?)");
  for (const BrdfRow& row : brdf.rows) {
    if (!row.interval) continue;
    insert_interval.bind(calibration).bind(row.point).bind(row.interval->u_per_sr);
    insert_interval.bind(row.interval->below_per_sr).bind(row.interval->above_per_sr).run();
  }
}

void RecordWriter::operator()(const AuditEntry& entry) {
  database_.statement("INSERT INTO audit(who, action, detail, utc_ns) VALUES (?,?,?,?)")
      .bind(entry.who)
      .bind(entry.action)
      .bind(entry.detail)
      .bind(time_.utc_ns)
      .run();
}

EventRecord RecordWriter::write_event(const NewEvent& event, std::int64_t number) {
  const ScanId scan = event.scan == 0 ? new_scan_ : event.scan;
  Statement& insert = database_.statement("INSERT INTO event VALUES (?,?,?,?,?,?,?,?,?)");
  insert.bind(number).bind(event.kind).bind(event.kind_version);
  scan == 0 ? insert.bind_null() : insert.bind(scan);
  insert.bind(event.who).bind(time_.run).bind(time_.boottime_ns).bind(time_.utc_ns).bind(event.json).run();
  return EventRecord{.number = number,
                     .kind = event.kind,
                     .kind_version = event.kind_version,
                     .scan = scan,
                     .who = event.who,
                     .utc = UtcTime(Duration(time_.utc_ns)),
                     .json = event.json};
}

}  // namespace gonio::daemon
