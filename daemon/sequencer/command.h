#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "daemon/sequencer/hand_reading.h"
#include "daemon/sequencer/lamp_warm_up.h"
#include "daemon/store/records.h"
#include "drivers/stage.h"

namespace gonio::daemon {

/// Names a command, so that its reply finds the client that waits. Given by the sender, unique while the daemon runs.
using CommandId = std::uint64_t;

/// Accepts a scan. The sender has parsed and expanded the plan (the planner's code: the dry run's). instrument_text and
/// instrument_hash are the daemon's own. Answered when the scan is durable.
struct SubmitScan {
  NewScan scan;
};
/// Waits after the item in hand, or (`now`) drops it.
struct PauseScan {
  ScanId scan = 0;
  bool now = false;
  std::string reason;
};
/// Clears one hold, or (none named) all whose cause is not seen to stand, and goes on, after preparing anew, when none
/// is left. What is left is named in the answer. Refused when nothing was cleared, and while the stage is stopped.
struct ResumeScan {
  ScanId scan = 0;
  std::optional<HoldName> hold{};
};
/// Ends early with data kept: closing dark, then parked.
struct FinishScan {
  ScanId scan = 0;
};
/// Ends at once; what was accepted stays.
struct AbortScan {
  ScanId scan = 0;
  std::string reason;
};
/// Gives up the item in hand (and its partner), recorded; of a scan that holds or prepares, the next one.
struct SkipItemInHand {
  ScanId scan = 0;
};
/// The order of the points that have neither sample nor reference yet.
enum class RestOrder : std::uint8_t { AsWritten, Reversed, Random, Fastest };
/// "as-written", "reversed", "random", "fastest".
[[nodiscard]] std::string_view rest_order_name(RestOrder order);
[[nodiscard]] std::optional<RestOrder> rest_order_from_name(std::string_view name);
/// Changes what is not measured yet; an item in hand is ended as it was begun. What is absent stays.
struct ChangeScan {
  ScanId scan = 0;
  std::optional<double> target_snr{};
  std::optional<Duration> max_time{};  ///< of one reading
  std::optional<RestOrder> order{};
  std::uint64_t seed = 1;  ///< of Random
  /// Of Fastest: the points in the order that the sender has found; those that it does not name follow as they were.
  std::vector<std::int32_t> fastest{};
  std::optional<int> priority{};
  std::optional<ScanTurn::Start> start{};  ///< only of a queued one
  std::string reason{};
};
/// By hand, while no scan runs (none active, or the active one holds). Answered when the axes stand.
struct MoveStage {
  drivers::MotionTarget target;
  std::optional<bool> source_shutter_open;
  std::optional<bool> detector_shutter_open;
};
struct HomeStage {};
/// Clears STOP, heartbeat trip and faults. Moves nothing, and resumes nothing.
struct ClearStage {};

/// One reading by hand, when MoveStage is allowed too. Shutters that it moves are put back as they stood.
struct ReadDetector {
  std::optional<Duration> exposure;  ///< of a camera; nothing: the middle of its exposures up to a second
  std::optional<double> range_w;     ///< of a radiometer, one of its ranges; nothing: the largest
  std::optional<bool> lit;           ///< both shutters open, or the detector's closed; nothing: as they stand
};

/// From now on what a calibration job has found counts, or (`in_use` false) does no more.
struct UseCalibration {
  CalibrationVersion version = 0;
  bool in_use = true;
  std::string reason{};
};
/// The BRDF of a scan is computed anew, without the instrument, once this is durable: with these versions of what
/// calibration jobs have found, or (none) with those that count then. What was computed before stays. Of a job's own
/// scan the job is fitted anew too.
struct RecomputeScan {
  ScanId scan = 0;
  std::optional<std::vector<CalibrationVersion>> versions{};
};

using Verb = std::variant<SubmitScan, PauseScan, ResumeScan, FinishScan, AbortScan, SkipItemInHand, MoveStage,
                          HomeStage, ClearStage, ReadDetector, ChangeScan, UseCalibration, RecomputeScan>;

struct Command {
  CommandId id = 0;
  std::string who;  ///< "uid:1000", a token's name, or "local"
  Verb verb;
};

/// The one answer to a command. `scan` is the scan concerned, 0 for the stage's.
/// Errors: WrongState (with the state and what is allowed in it), NotFound, Busy, OutOfLimits, Blocked, store and
/// device errors.
struct CommandDone {
  ScanId scan = 0;
  bool existed = false;  ///< SubmitScan: the idempotency key was known; `scan` is the one it made then
  std::optional<HandReading> reading = std::nullopt;  ///< of ReadDetector
  std::string note{};  ///< what is to be known besides: holds that are left, the item skipped
};
struct CommandReply {
  CommandId id = 0;
  Result<CommandDone> result;
};

/// How far a scan is, with an honest estimate.
struct Progress {
  ScanId scan = 0;
  std::string name;
  ScanState state = ScanState::Queued;
  std::vector<Hold> holds;
  std::int64_t points = 0;
  std::int64_t blocked = 0;
  std::int64_t merged = 0;
  std::int64_t items = 0;
  std::int64_t accepted = 0;
  std::int64_t skipped = 0;
  std::int64_t failed_attempts = 0;  ///< since the daemon started
  std::optional<ItemKey> in_hand;
  TimeParts spent;                    ///< of attempts and visits
  std::optional<Duration> remaining;  ///< from measured times; before the first item of this run as predicted
  Duration u_remaining{};             ///< standard uncertainty of it
  std::int64_t learned_from = 0;      ///< finished scans whose time the prediction rests on
};

/// What `GET status` shows of the sequencer: a value, copied out after each message.
struct SequencerStatus {
  std::optional<Progress> active;
  std::vector<ScanId> aside;              ///< pre-empted: they go on, the last first, when the active one is over
  std::vector<ScanId> queued;             ///< in the order in which they would run if all might start now
  std::string doing;                      ///< "exposing", "moving", "idle"
  bool stage_stopped = false;             ///< STOP stands: reset needed
  std::optional<WarmUpProgress> warm_up;  ///< while a scan waits for the lamp
  std::optional<Error> store_error;       ///< the store failed: nothing goes on until a resume reloads it
};

}  // namespace gonio::daemon
