#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/clock.h"
#include "base/error.h"
#include "calibration/jobs/found_values.h"
#include "calibration/jobs/pixel_sums.h"
#include "calibration/raw_reading.h"
#include "daemon/planner/planned_scan.h"
#include "drivers/detector.h"
#include "drivers/stage.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {

using ScanId = std::int64_t;              ///< > 0
using CalibrationVersion = std::int64_t;  ///< > 0: of what a calibration job found

/// The life of a scan (DESIGN 5). Names as stored and shown: "queued", "finished-early".
enum class ScanState : std::uint8_t {
  Queued,
  Preparing,
  Running,
  Holding,
  Finishing,
  Done,
  FinishedEarly,
  Aborted,
  Failed,
  Interrupted,
};
inline constexpr std::array<ScanState, 10> kAllScanStates{
    ScanState::Queued, ScanState::Preparing,     ScanState::Running, ScanState::Holding, ScanState::Finishing,
    ScanState::Done,   ScanState::FinishedEarly, ScanState::Aborted, ScanState::Failed,  ScanState::Interrupted};
[[nodiscard]] std::string_view scan_state_name(ScanState state);
[[nodiscard]] std::optional<ScanState> scan_state_from_name(std::string_view name);
[[nodiscard]] constexpr bool is_over(ScanState s) {
  return s == ScanState::Done || s == ScanState::FinishedEarly || s == ScanState::Aborted || s == ScanState::Failed;
}

/// Why a scan waits. Names: "operator", "lamp", "door", "device", "disk", "restart", "preempted".
enum class HoldName : std::uint8_t { Operator, Lamp, Door, Device, Disk, Restart, Preempted };
[[nodiscard]] std::string_view hold_name(HoldName name);
[[nodiscard]] std::optional<HoldName> hold_from_name(std::string_view name);

struct Hold {
  HoldName name = HoldName::Operator;
  std::string owner;  ///< who asked for it, or the device
  std::string reason;
  Instant since{};  ///< as this boot counts
};

/// "sample", "reference", "dark".
[[nodiscard]] std::string_view target_name(calibration::Target target);
[[nodiscard]] std::optional<calibration::Target> target_from_name(std::string_view name);

/// The unit of acceptance.
struct ItemKey {
  std::int32_t point = 0;
  calibration::Target target = calibration::Target::Sample;
  friend auto operator<=>(const ItemKey&, const ItemKey&) = default;
};

/// A reading of a radiometer, and when it was taken: a row of `power_reading`.
struct PowerRecord {
  calibration::PowerReading reading;
  Instant started{};
  Instant ended{};
};

/// One detector result, raw: a row of `reading`.
struct ReadingRecord {
  bool used = true;  ///< false: a probe, or saturated; kept, never calibrated with
  calibration::RegionMoments region;
  std::optional<calibration::ReducedMean> reduced;  ///< with maps; not of a saturated frame
  std::string maps_version;                         ///< SHA-256 of the maps; empty: none
  drivers::ExposureSettings settings;
  std::uint64_t camera_frame_id = 0;
  std::uint64_t camera_time_ns = 0;
  std::optional<double> camera_temperature_c;  ///< nothing: the camera has no sensor
  std::uint32_t gate_count = 0;                ///< the stage's number of this exposure
  stage::PerAxis<std::int32_t> open_counts{};
  stage::PerAxis<std::int32_t> close_counts{};
  double monitor_mean = 0.0;
  double monitor_se = 0.0;
  std::uint32_t monitor_samples = 0;
  double lamp_temperature_c = 0.0;
  double detector_temperature_c = 0.0;
  double room_temperature_c = 0.0;
  double humidity_percent = 0.0;
  Instant at{};                              ///< middle of the exposure
  std::optional<PowerRecord> power;          ///< of a radiometer as detector; its overload has none
  std::optional<PowerRecord> monitor_power;  ///< of a radiometer as lamp monitor
};

// ---- what can be written ----

/// What a map job keeps of the frames of one attempt or visit at one exposure: a row of `pixel_sum`. Complete: nobody
/// adds to it any more.
using PixelSumRecord = std::shared_ptr<const calibration::PixelSums>;

/// How a scan is measured once its points are fixed: the plan's parts that the sequencer goes by, stored with the scan.
struct ScanPolicy {
  double target_snr = 300.0;
  Duration max_time{};
  std::vector<Duration> exposures{};  ///< ascending; empty: chosen for each reading
  Duration block{};
  Duration dark_every{};
  int item_retries = 2;
  api::OnItemError on_item_error = api::OnItemError::Skip;
  api::OnRestart on_restart = api::OnRestart::Resume;
  Duration reference_every{};  ///< zero: no such visits
  Duration check_every{};      ///< likewise
  double drift_limit = 0.005;  ///< relative, between two visits
  int drift_rounds = 2;        ///< how often a point is measured again for it
  api::ReferenceMode reference_mode = api::ReferenceMode::SameGeometry;
  Geometry anchor{.theta_i = {}, .phi_i = {}, .theta_r = degrees(45.0), .phi_r = {}};  ///< in anchor mode
  int map_frames = 0;  ///< of a map job: frames of each exposure in a dark visit, and frames are summed; 0: no such job
  friend bool operator==(const ScanPolicy&, const ScanPolicy&) = default;
};
[[nodiscard]] ScanPolicy policy_of(const api::Plan& plan);
/// With what a budget chose.
[[nodiscard]] ScanPolicy policy_of(const api::Plan& plan, const PlannedScan& planned);

/// A scan's place in the queue.
struct ScanTurn {
  /// In both times: UTC is what was asked for, `at` what the daemon waits for. A step of the clock does not move it
  /// before the next start of the daemon.
  struct Start {
    Instant at{};
    UtcTime utc{};
  };
  int priority = 0;            ///< higher ones first, -100 to 100; of equal ones the older
  bool preempts = false;       ///< runs inside a scan of lower priority, which holds meanwhile
  std::optional<Start> start;  ///< not before
  ScanId completes = 0;        ///< the scan whose missing points these are; 0: none
};
inline constexpr int kHighestPriority = 100;

/// Accepts a scan, with everything that it will ever be recomputed from. Its points become rows here.
/// An idempotency key that is there already writes nothing; the receipt then names the scan that has it.
struct NewScan {
  std::string idempotency_key;  ///< empty: none
  std::string name;
  std::string campaign;  ///< may be empty
  std::string sample;
  bool isotropic = true;
  ScanPolicy policy;
  std::string plan_text;                          ///< as sent
  std::string plan_file;                          ///< the user's name for it
  std::map<std::string, std::string> plan_parts;  ///< the files that it names, by name
  std::string reference_serial;
  std::string reference_text;   ///< reference/*.toml, as used
  std::string instrument_text;  ///< instrument.toml, as used
  std::string instrument_hash;  ///< of what counts: addresses are not part of it
  PlannedScan planned;
  std::string who;
  ScanTurn turn{};
};

/// Writes `state`; what was asked for at the end of it stays known across a restart.
struct ScanTransition {
  ScanId scan = 0;
  ScanState from = ScanState::Queued;
  ScanState to = ScanState::Queued;
  bool finish_asked = false;
  std::string who;
  std::string reason;  ///< becomes the scan's outcome when `to` is an end
};
struct AddHold {
  ScanId scan = 0;
  Hold hold;
};
struct ClearHolds {
  ScanId scan = 0;
  std::string who;
  std::vector<HoldName> names{};  ///< empty: all
};
/// Changes what is not measured yet. What is absent stays.
struct ScanChange {
  ScanId scan = 0;
  std::optional<double> target_snr{};
  std::optional<Duration> max_time{};
  std::optional<int> priority{};
  std::optional<ScanTurn::Start> start{};
  /// The points still to be measured, in their new order: they share out the ranks that they have.
  std::vector<std::int32_t> order{};
};

/// "dark", "reference" (the standard at one geometry), "check" (the sample likewise).
enum class VisitKind : std::uint8_t { Dark, Reference, Check };
inline constexpr std::array<VisitKind, 3> kAllVisitKinds{VisitKind::Dark, VisitKind::Reference, VisitKind::Check};
[[nodiscard]] std::string_view visit_kind_name(VisitKind kind);

/// What a lit visit saw.
struct VisitLevel {
  std::int32_t point = 0;  ///< the plan's, whose geometry and wavelength it was made at
  /// Light per unit of exposure and monitor above the dark, as the sequencer judges it (the calibration makes its own
  /// of the readings); of a check, where the plan has reference visits too, in units of the one before it.
  double level = 0.0;
  double u_relative = 0.0;      ///< standard uncertainty of it
  std::optional<double> drift;  ///< relative, since the visit of this kind before; none: it is the first
};

enum class AttemptOutcome : std::uint8_t { Accepted, Failed, Dropped };
/// One try at an item with all its readings. `Accepted` also writes the item's row of this round; a second acceptance
/// in one round is refused by the schema and fails the transaction.
struct NewAttempt {
  ScanId scan = 0;
  ItemKey item;
  AttemptOutcome outcome = AttemptOutcome::Accepted;
  std::optional<Error> error;  ///< of a failed one
  TimeParts time;
  std::vector<ReadingRecord> readings;
  Instant started{};
  std::vector<PixelSumRecord> pixel_sums{};  ///< of a map job's accepted reading of the standard
};
/// Decides an item without a reading.
struct SkipItem {
  ScanId scan = 0;
  ItemKey item;
  std::string who;
  std::string reason;
};
/// A visit with all its readings. What it reopens is open again by the same transaction: the decision stays and counts
/// no more, the next one is of the next round. An item that is not accepted in its present round fails the transaction.
struct NewVisit {
  ScanId scan = 0;
  TimeParts time;
  std::vector<ReadingRecord> readings;
  Instant started{};
  VisitKind kind = VisitKind::Dark;
  std::optional<VisitLevel> level;  ///< of a reference or check visit
  std::vector<ItemKey> reopened;
  std::vector<PixelSumRecord> pixel_sums{};  ///< of a map job's dark
};

/// A 95.45 % interval that does not follow from a row's terms and degrees of freedom: by Monte Carlo, or with a
/// dominant error that has bounds. In sr^-1.
struct StoredInterval {
  double u_per_sr = 0.0;      ///< combined standard uncertainty
  double below_per_sr = 0.0;  ///< the interval is [value - below, value + above]
  double above_per_sr = 0.0;
  friend bool operator==(const StoredInterval&, const StoredInterval&) = default;
};
/// One BRDF value as stored. Values in sr^-1.
struct BrdfRow {
  std::int32_t point = 0;
  double value_per_sr = 0.0;
  double u_random_per_sr = 0.0;
  double effective_dof = 0.0;  ///< of the whole; +infinity is stored as 0: "no less than normal"
  std::uint32_t flags = 0;
  Geometry reported;  ///< the directions that the value holds for
  /// The shared terms that are not zero, as pairs (component's place in `component_names`, c_k u_k in sr^-1),
  /// flattened: a long scan has hundreds of components (each dark visit is one) and a point few of them.
  std::vector<double> sensitivities_per_sr;
  std::optional<StoredInterval> interval{};  ///< none: +- k u of the terms above
};
/// The BRDF of a scan by one calibration. A scan has as many as it was computed; the newest counts.
struct NewBrdf {
  ScanId scan = 0;
  std::string code_version;
  std::string inputs_json;                   ///< certificate, models: what it was computed from
  std::vector<std::string> component_names;  ///< of `sensitivities_per_sr`
  std::vector<BrdfRow> rows;
  std::vector<CalibrationVersion> versions{};  ///< that it was computed with, ascending; empty: instrument.toml alone
  std::vector<std::uint32_t> sizes_only{};     ///< places of components whose terms have no known sign, ascending
};
/// What a calibration job has found: it becomes a version, and counts for nothing before it is used.
struct NewFoundCalibration {
  ScanId scan = 0;  ///< the job's
  std::string job;  ///< "linearity"
  std::string code_version;
  std::string inputs_json;
  calibration::FoundValues found;
};
/// From now on this version of its job counts, or none of that job does.
struct UseCalibrationVersion {
  CalibrationVersion version = 0;
  bool in_use = true;
  std::string who;
  std::string reason;
};
/// Who changed what.
struct AuditEntry {
  std::string who;
  std::string action;
  std::string detail;
};

using StoreWrite = std::variant<NewScan, ScanTransition, AddHold, ClearHolds, NewAttempt, SkipItem, NewVisit, NewBrdf,
                                AuditEntry, ScanChange, NewFoundCalibration, UseCalibrationVersion>;

/// What clients are told, once it is durable.
struct NewEvent {
  std::string kind;  ///< "item-accepted"; the list is in daemon/sequencer/README.md
  int kind_version = 1;
  ScanId scan = 0;  ///< 0: of no scan, or of the scan made in this transaction
  std::string who;
  std::string json;  ///< an object
};

/// Written whole or not at all, in this order.
struct StoreTransaction {
  Instant at{};
  std::vector<StoreWrite> writes;
  std::vector<NewEvent> events;
};

// ---- what comes back ----

struct EventRecord {
  std::int64_t number = 0;  ///< gapless, from 1
  std::string kind;
  int kind_version = 1;
  ScanId scan = 0;
  std::string who;
  UtcTime utc{};
  std::string json;
};

struct CommitReceipt {
  ScanId new_scan = 0;   ///< of NewScan
  bool existed = false;  ///< NewScan found its idempotency key: nothing of the transaction was written
  std::vector<EventRecord> events;
};

/// The last lit visit of one kind, and the items in force that were accepted after it: nobody has judged them yet.
struct LastVisit {
  std::optional<VisitLevel> level;  ///< none: there was no such visit
  std::vector<ItemKey> since;
};

/// A scan that is not over, as the store has it.
struct UnfinishedScan {
  ScanId id = 0;
  ScanState state = ScanState::Queued;
  bool finish_asked = false;
  std::string name;
  ScanPolicy policy;
  bool isotropic = true;
  std::string instrument_hash;
  std::vector<ScanPoint> points;  ///< by index
  std::vector<std::int32_t> order;
  std::int64_t merged = 0;
  std::vector<ItemKey> accepted;
  std::vector<ItemKey> skipped;
  std::vector<std::pair<ItemKey, int>> attempts;  ///< how many, of items that are not decided
  std::vector<Hold> holds;
  std::vector<Duration> exposures_used;  ///< rungs that accepted readings used: each needs its closing dark
  bool dark_owed = false;                ///< light was taken after the last dark visit
  LastVisit last_reference;
  LastVisit last_check;
  std::vector<std::pair<std::int32_t, int>> reopened;  ///< points, and how often
  double largest_drift = 0.0;                          ///< seen between two visits
  TimeParts spent;
  ScanTurn turn{};
  std::optional<PredictedTime> predicted{};  ///< none: it completes another scan, or is older than predictions
};

}  // namespace gonio::daemon
