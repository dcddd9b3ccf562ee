#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "daemon/store/database.h"
#include "daemon/store/records.h"

namespace gonio::daemon {

/// The moment of a transaction in both times, with the run that it belongs to.
struct WriteTime {
  std::int64_t run = 0;
  std::int64_t boottime_ns = 0;
  std::int64_t utc_ns = 0;
  [[nodiscard]] std::int64_t utc_of(Instant at) const { return utc_ns + at.time_since_epoch().count() - boottime_ns; }
};

/// Writes the records of one transaction, which its caller has begun. Errors stick in the database. Threads: the
/// database's.
class RecordWriter {
 public:
  RecordWriter(Database& database, WriteTime time) : database_(database), time_(time) {}

  void operator()(const NewScan& scan);
  void operator()(const ScanTransition& transition);
  void operator()(const AddHold& add);
  void operator()(const ClearHolds& clear);
  void operator()(const NewAttempt& attempt);
  void operator()(const SkipItem& skip);
  void operator()(const NewVisit& visit);
  void operator()(const NewBrdf& brdf);
  void operator()(const AuditEntry& entry);
  void operator()(const ScanChange& change);
  void operator()(const NewFoundCalibration& found);
  void operator()(const UseCalibrationVersion& use);
  /// An event's own number is the caller's: gapless.
  [[nodiscard]] EventRecord write_event(const NewEvent& event, std::int64_t number);

  /// Of the NewScan written, else 0.
  [[nodiscard]] ScanId new_scan() const { return new_scan_; }

 private:
  std::int64_t id_of_sample(const std::string& name);
  std::int64_t id_of_campaign(const std::string& name);
  std::int64_t id_of_reference(const NewScan& scan);
  std::int64_t id_of_instrument(const NewScan& scan);
  void write_plan_parts(const std::map<std::string, std::string>& parts);
  void write_prediction(const PlannedScan& planned);
  void write_points(const std::vector<ScanPoint>& points);
  void write_turn(ScanId scan, const ScanTurn& turn);
  void write_order(ScanId scan, const std::vector<std::int32_t>& order);
  void bind_time_parts(Statement& statement, const TimeParts& time);
  void write_power(std::int64_t reading, const char* role, const PowerRecord& power);
  void write_reading(const ReadingRecord& reading, std::int64_t attempt, std::int64_t visit, std::int64_t sequence);
  void write_pixel_sums(const calibration::PixelSums& sums, std::int64_t attempt, std::int64_t visit);
  void write_reduction(const calibration::ReducedMean& reduced, const std::string& maps_version, std::int64_t reading);
  void write_level(const NewVisit& visit, std::int64_t id);
  void reopen(ScanId scan, const ItemKey& item, std::int64_t visit);
  void write_item(ScanId scan, const ItemKey& item, std::int64_t attempt, const std::string& who,
                  const std::string& reason);

  Database& database_;
  WriteTime time_;
  ScanId new_scan_ = 0;
};

}  // namespace gonio::daemon
