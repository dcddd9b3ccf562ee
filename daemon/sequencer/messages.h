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
#include "drivers/detector.h"
#include "drivers/stage.h"
#include "daemon/store/records.h"

namespace gonio::daemon {

/// Pairs a request with its answer. An answer to a request that was withdrawn is recognised and dropped.
using Ticket = std::uint64_t;

// ---- what the sequencer asks for (to the device, store and halt threads) ----

/// Move, and answer when every named axis has stayed in its window for its settle time, or why not.
struct MoveTo {
  Ticket ticket = 0;
  drivers::Epoch epoch = 0;
  drivers::MotionTarget target;
  std::optional<bool> source_shutter_open;    ///< set along with the move, before it counts as done
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
/// Wait until the stage's gate has counted `after + 1` and has closed; answers with the state that holds the gate record.
/// `expected` is how long the exposure lasts: the first look is then, and the deadline follows from it.
struct WatchGate {
  Ticket ticket = 0;
  std::uint32_t after = 0;
  Duration expected{};
  /// The positions that must hold at gate open and close, within each axis' window: else OutOfTolerance.
  drivers::MotionTarget held;
};
/// Apply the settings if they changed, trigger, collect, reduce: one frame.
struct TakeFrame {
  Ticket ticket = 0;
  drivers::ExposureSettings settings;
};
/// Open the camera, write its settings, read them back.
struct PrepareDetector {
  Ticket ticket = 0;
};
/// Make this durable, as one transaction.
struct Commit {
  Ticket ticket = 0;
  StoreTransaction transaction;
};

using Request = std::variant<MoveTo, Home, ResetStage, LookAtStage, WatchGate, TakeFrame, PrepareDetector, Commit>;

// ---- what the sequencer is told ----

/// The answer to MoveTo, Home, ResetStage, LookAtStage, WatchGate.
struct StageAnswer {
  Ticket ticket = 0;
  Result<drivers::StageState> state;
};
struct FrameSummary {
  calibration::RegionMoments region;
  drivers::ExposureSettings settings;   ///< as read back
  std::uint64_t frame_id = 0;
  std::uint64_t camera_time_ns = 0;
  double temperature_c = 0.0;
};
/// The answer to TakeFrame.
struct FrameAnswer {
  Ticket ticket = 0;
  Result<FrameSummary> frame;
};
/// The answer to PrepareDetector.
struct DetectorAnswer {
  Ticket ticket = 0;
  Result<drivers::DetectorIdentity> detector;
};
/// The answer to Commit: the ids given, and the committed events, in order, ready to publish.
struct CommitAnswer {
  Ticket ticket = 0;
  Result<CommitReceipt> receipt;
};
/// A command of a client; `reply` gets the outcome once (see CommandReply). Verbs in daemon/sequencer/command.h.
struct StopHappened {
  drivers::Epoch epoch = 0;  ///< the new one
  std::string who;
};
struct Tick {};

}  // namespace gonio::daemon
