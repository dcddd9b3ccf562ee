// What calibration jobs found, written and read; and which of it counts.
#include "daemon/store/found_calibrations.h"

#include <map>
#include <string>

#include "daemon/store/record_writer.h"

namespace gonio::daemon {

void RecordWriter::operator()(const NewFoundCalibration& found) {
  database_
      .statement(
          "INSERT INTO found_calibration(scan_id, job, code_version, inputs_json, covariance, note, utc_ns) "
          "VALUES (?,?,?,?,?,?,?)")
      .bind(found.scan)
      .bind(found.job)
      .bind(found.code_version)
      .bind(found.inputs_json)
      .bind_blob(found.found.covariance)
      .bind(found.found.note)
      .bind(time_.utc_ns)
      .run();
  const std::int64_t version = database_.last_id();
  Statement& insert = database_.statement("INSERT INTO found_value VALUES (?,?,?,?,?)");
  std::int64_t place = 0;
  for (const calibration::FoundValue& value : found.found.values) {
    insert.bind(version).bind(place++).bind(value.name).bind(value.unit).bind(value.value).run();
  }
}

void RecordWriter::operator()(const UseCalibrationVersion& use) {
  database_.statement("INSERT INTO calibration_use(version, in_use, who, reason, utc_ns) VALUES (?,?,?,?,?)")
      .bind(use.version)
      .bind(use.in_use)
      .bind(use.who)
      .bind(use.reason)
      .bind(time_.utc_ns)
      .run();
}

namespace {

std::vector<FoundCalibration> read_versions(Database& database) {
  std::vector<FoundCalibration> all;
  Statement& query = database.statement(
      "SELECT version, f.scan_id, job, p.name, code_version, inputs_json, covariance, note, utc_ns FROM "
      "found_calibration f JOIN scan s ON s.scan_id = f.scan_id JOIN sample p USING (sample_id) ORDER BY version");
  while (query.next()) {
    FoundCalibration one{.version = query.integer(0),
                         .scan = query.integer(1),
                         .job = query.text(2),
                         .sample = query.text(3),
                         .code_version = query.text(4),
                         .inputs_json = query.text(5),
                         .at = UtcTime(Duration(query.integer(8)))};
    const auto covariance = query.doubles(6);
    one.found.covariance.assign(covariance.begin(), covariance.end());
    one.found.note = query.text(7);
    all.push_back(std::move(one));
  }
  return all;
}

void add_values(Database& database, std::map<CalibrationVersion, FoundCalibration*>& known) {
  Statement& query = database.statement("SELECT version, name, unit, value FROM found_value ORDER BY version, place");
  while (query.next()) {
    known.at(query.integer(0))
        ->found.values.push_back({.name = query.text(1), .unit = query.text(2), .value = query.real(3)});
  }
}

// The last use of a job, of whatever version, says what counts.
void add_uses(Database& database, std::map<CalibrationVersion, FoundCalibration*>& known) {
  std::map<std::string, FoundCalibration*> in_use;
  Statement& query =
      database.statement("SELECT version, in_use, who, reason, utc_ns FROM calibration_use ORDER BY use_id");
  while (query.next()) {
    FoundCalibration& one = *known.at(query.integer(0));
    one.uses.push_back({.in_use = query.integer(1) != 0,
                        .who = query.text(2),
                        .reason = query.text(3),
                        .at = UtcTime(Duration(query.integer(4)))});
    in_use[one.job] = one.uses.back().in_use ? &one : nullptr;
  }
  for (const auto& [job, one] : in_use) {
    if (one != nullptr) one->counts = true;
  }
}

}  // namespace

std::vector<FoundCalibration> read_found_calibrations(Database& database) {
  std::vector<FoundCalibration> all = read_versions(database);
  std::map<CalibrationVersion, FoundCalibration*> known;
  for (FoundCalibration& one : all) known[one.version] = &one;
  add_values(database, known);
  add_uses(database, known);
  return all;
}

}  // namespace gonio::daemon
