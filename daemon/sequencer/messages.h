#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "calibration/raw_reading.h"
#include "daemon/sequencer/command.h"
#include "daemon/store/records.h"
#include "drivers/detector.h"
#include "drivers/stage.h"

namespace gonio::daemon {

/// Pairs a request with its one answer. Every request is answered, within its own deadline, also when it failed.
/// The sequencer has at most one stage, one detector and one monitor request and a few commits open at a time; it never
/// withdraws one: an answer that it no longer wants is awaited, then dropped.
using Ticket = std::uint64_t;
/// Of looks at the stage that others ask for: the sequencer watches door and lamp by their answers.
inline constexpr Ticket kWatchTicket = Ticket{1} << 63U;

// ---- what the sequencer asks for (to the device and store threads) ----

/// Move, and answer when every named axis has stayed in its window for its settle time, or why not. Without an axis:
/// only the shutters, and the state after them.
struct MoveTo {
  Ticket ticket = 0;
  drivers::Epoch epoch = 0;
  drivers::MotionTarget target;
  std::optional<bool> source_shutter_open;  ///< set along with the move; it counts as done when they stand as asked
  std::optional<bool> detector_shutter_open;
};
/// Home all axes, and answer when done.
struct Home {
  Ticket ticket = 0;
  drivers::Epoch epoch = 0;
};
/// Clear latch, trip and faults; answers with the state after it.
struct ResetStage {
  Ticket ticket = 0;
  drivers::Epoch epoch = 0;
};
/// One look at the stage.
struct LookAtStage {
  Ticket ticket = 0;
};
/// Wait until the stage's gate has counted `after + 1` and has closed; answers with the state that holds the gate
/// record. `expected` is how long the exposure lasts: the first look is then, and the deadline follows from it.
struct WatchGate {
  Ticket ticket = 0;
  std::uint32_t after = 0;
  Duration expected{};
  /// The positions that must hold at gate open and close, within each axis' window: else OutOfTolerance.
  drivers::MotionTarget held;
};
/// What a radiometer in the camera's place is told.
struct PowerSettings {
  double range_w = 0.0;   ///< full scale
  Wavelength wavelength;  ///< one for the whole scan: darks hold for it only
};
/// Apply the settings if they changed, trigger, collect, reduce: one frame, or one reading of a radiometer.
struct TakeFrame {
  Ticket ticket = 0;
  drivers::ExposureSettings settings;
  std::optional<PowerSettings> power;  ///< of a radiometer
  /// Of a map job: the frame is added to it before the answer, and whoever asks touches it after the answer only. A
  /// frame that cannot be added is an error. Nullptr: frames are condensed and gone.
  std::shared_ptr<calibration::PixelSums> sums = nullptr;
};
/// Open the detector, write its settings, read them back.
struct PrepareDetector {
  Ticket ticket = 0;
};
/// Take the dark that is there as zero: a radiometer's, its shutter is closed.
struct ZeroDetector {
  Ticket ticket = 0;
};
/// Read a radiometer in the lamp's light for `window` or a little longer, from now on.
struct TakeMonitor {
  Ticket ticket = 0;
  Duration window{};
};
struct PrepareMonitor {
  Ticket ticket = 0;
};
/// Make this durable, as one transaction. In the order of asking.
struct Commit {
  Ticket ticket = 0;
  StoreTransaction transaction;
};
/// Read the scans that are not over.
struct LoadUnfinished {
  Ticket ticket = 0;
};

using StageRequest = std::variant<MoveTo, Home, ResetStage, LookAtStage, WatchGate>;
using DetectorRequest = std::variant<TakeFrame, PrepareDetector, ZeroDetector>;
using MonitorRequest = std::variant<TakeMonitor, PrepareMonitor>;
using StoreRequest = std::variant<Commit, LoadUnfinished>;
using Request = std::variant<StageRequest, DetectorRequest, MonitorRequest, StoreRequest>;

// ---- what the sequencer is told ----

/// The answer to every StageRequest.
struct StageAnswer {
  Ticket ticket = 0;
  Result<drivers::StageState> state;
};
/// A radiometer shows itself as one pixel, in parts of its range: `region` has what exposures are chosen by.
struct FrameSummary {
  calibration::RegionMoments region;
  std::optional<calibration::ReducedMean> reduced;  ///< with maps; not of a saturated frame
  std::string maps_version;                         ///< what it was reduced with; empty: no maps
  drivers::ExposureSettings settings;               ///< as read back
  std::uint64_t frame_id = 0;
  std::uint64_t camera_time_ns = 0;
  std::optional<double> temperature_c;  ///< nothing: the camera has no sensor
  std::optional<PowerRecord> power;
};
/// The answer to TakeFrame. An overload of a radiometer is a saturated pixel, without `power`.
struct FrameAnswer {
  Ticket ticket = 0;
  Result<FrameSummary> frame;
};
/// The answer to PrepareDetector and ZeroDetector.
struct DetectorAnswer {
  Ticket ticket = 0;
  Result<drivers::DetectorIdentity> detector;
};
/// The answer to TakeMonitor.
struct MonitorAnswer {
  Ticket ticket = 0;
  Result<PowerRecord> reading;
};
/// The answer to PrepareMonitor.
struct MonitorReady {
  Ticket ticket = 0;
  Result<drivers::DetectorIdentity> monitor;
};
/// The answer to Commit: what was made, and the committed events in order. The store's thread publishes them itself.
struct CommitAnswer {
  Ticket ticket = 0;
  Result<CommitReceipt> receipt;
};
/// The answer to LoadUnfinished.
struct UnfinishedAnswer {
  Ticket ticket = 0;
  Result<std::vector<UnfinishedScan>> scans;
};
/// STOP was given, and the halt is on the wire (or failed: the stage's heartbeat then stops it).
struct StopHappened {
  drivers::Epoch epoch = 0;  ///< the new one
  std::string who;
};

/// What is free on the store's disk: now and then, and whenever it has changed much.
struct DiskSeen {
  std::int64_t free_bytes = 0;
};

/// New kinds come last: a tape knows them by their place.
using SequencerMessage = std::variant<Command, StageAnswer, FrameAnswer, DetectorAnswer, CommitAnswer, UnfinishedAnswer,
                                      StopHappened, MonitorAnswer, MonitorReady, DiskSeen>;

}  // namespace gonio::daemon
