#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calibration/raw_reading.h"
#include "daemon/planner/time_experience.h"
#include "daemon/store/records.h"
#include "drivers/stage_config.h"

namespace gonio::daemon {

struct ScanCounts {
  std::int64_t points = 0;  ///< blocked ones included
  std::int64_t merged = 0;
  std::int64_t blocked = 0;
  std::int64_t items = 0;  ///< to be decided: sample and reference of the points not blocked
  std::int64_t accepted = 0;
  std::int64_t skipped = 0;
  std::int64_t attempts = 0;  ///< failed and dropped ones included
  std::int64_t visits = 0;
  std::int64_t reference_visits = 0;  ///< of the visits; the rest are darks
  std::int64_t check_visits = 0;
  std::int64_t reopened = 0;  ///< points that a drift made to be measured again
};

struct ScanInfo {
  ScanId id = 0;
  std::string name;
  std::string campaign;
  std::string sample;
  bool isotropic = true;
  ScanState state = ScanState::Queued;
  std::string outcome;  ///< why it ended
  std::string who;
  std::string reference_serial;
  std::string instrument_hash;
  ScanPolicy policy;
  UtcTime submitted{};
  UtcTime changed{};  ///< last transition
  ScanCounts counts;
  TimeParts spent;             ///< sums over all attempts and visits
  double largest_drift = 0.0;  ///< relative, between two lit visits of one kind
  std::vector<Hold> holds;     ///< since: only differences within this boot mean something
  ScanTurn turn;               ///< of its start, UTC only
  ScanId completed_by = 0;     ///< the newest scan that was made of its missing points; 0: none
};

/// The texts a scan was accepted with, as they were.
struct ScanTexts {
  std::string plan;
  std::string plan_file;
  std::map<std::string, std::string> plan_parts;  ///< the files that the plan names, by name
  std::string reference;
  std::string instrument;
  std::string plan_sha256;  ///< hex
  std::string reference_sha256;
  std::string instrument_sha256;
  UtcTime submitted{};  ///< the day on which its certificate must hold
};

/// A point with what became of it.
struct PointInfo {
  ScanPoint point;
  std::string sample_outcome;  ///< "accepted", "skipped", or empty while open
  std::string reference_outcome;
  int attempts = 0;
};

struct BrdfInfo {
  std::int64_t calibration = 0;
  std::string code_version;
  std::string inputs_json;
  std::vector<std::string> component_names;
  std::vector<BrdfRow> rows;  ///< by point
  std::vector<CalibrationVersion> versions{};
  std::vector<std::uint32_t> sizes_only{};  ///< as NewBrdf::sizes_only
};

/// A change of what counts.
struct CalibrationUse {
  bool in_use = true;
  std::string who;
  std::string reason;
  UtcTime at{};
};
/// What a calibration job has found, with its history.
struct FoundCalibration {
  CalibrationVersion version = 0;
  ScanId scan = 0;
  std::string job;
  std::string sample;  ///< of the job's scan: the mirror, the check standard
  std::string code_version;
  std::string inputs_json;
  calibration::FoundValues found;
  UtcTime at{};
  std::vector<CalibrationUse> uses;  ///< oldest first
  bool counts = false;               ///< the last use of its job names it
};

/// The frames that a map job has summed, all readings of one exposure together; one stack for each exposure.
struct PixelStacks {
  std::vector<calibration::PixelStack> dark;
  std::vector<calibration::PixelStack> lit;  ///< of the standard
};

/// Reads the store on its own read-only connection, beside the writer. Threads: one; any number of readers, also in
/// other processes. Every call is one consistent look. Errors of all: StoreFailed; NotFound for a scan that is not
/// there.
class StoreReader {
 public:
  /// Errors: StoreFailed (no file, no permission), StoreTooNew.
  [[nodiscard]] static Result<std::unique_ptr<StoreReader>> open(const std::string& path);
  virtual ~StoreReader() = default;

  /// Newest first; `before` = 0 starts at the newest, else scans older than it.
  [[nodiscard]] virtual Result<std::vector<ScanInfo>> scans(ScanId before, int at_most) = 0;
  [[nodiscard]] virtual Result<ScanInfo> scan(ScanId id) = 0;
  [[nodiscard]] virtual Result<ScanTexts> texts(ScanId id) = 0;
  /// Points with index > `after` (-1: from the first).
  [[nodiscard]] virtual Result<std::vector<PointInfo>> points(ScanId id, std::int32_t after, int at_most) = 0;
  /// Accepted attempts (of an item that was measured again the last one) and all visits in time order; encoder counts
  /// become directions by the kinematics of `stage`, each phi within half a turn of the planned one. Frames of one
  /// attempt or visit at one exposure are one RawReading; its visit_id is 2 * attempt or 2 * visit + 1.
  [[nodiscard]] virtual Result<calibration::ScanReadings> readings(ScanId id, const drivers::StageConfig& stage) = 0;
  /// Events with number > `after`, in order; `scan` = 0: of all.
  [[nodiscard]] virtual Result<std::vector<EventRecord>> events(std::int64_t after, int at_most, ScanId scan) = 0;
  [[nodiscard]] virtual Result<std::int64_t> last_event() = 0;
  /// The newest BRDF. Errors: NotFound when none was computed yet.
  [[nodiscard]] virtual Result<BrdfInfo> brdf(ScanId id) = 0;
  /// All that calibration jobs have found, oldest first.
  [[nodiscard]] virtual Result<std::vector<FoundCalibration>> found_calibrations() = 0;
  /// Of the accepted readings and the dark visits of a map job's scan; none of another. Errors: IncompleteData (sums of
  /// two apertures or gains).
  [[nodiscard]] virtual Result<PixelStacks> pixel_stacks(ScanId id) = 0;
  /// What the last finished scans of this configuration took beside what was predicted for them.
  [[nodiscard]] virtual Result<TimeExperience> time_experience(const std::string& configuration_hash) = 0;
  /// All scans that are not over, oldest first. For the sequencer's start.
  [[nodiscard]] virtual Result<std::vector<UnfinishedScan>> unfinished(Instant now, UtcTime utc_now) = 0;
};

}  // namespace gonio::daemon
