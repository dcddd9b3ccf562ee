#pragma once

#include <cstdint>
#include <optional>

#include "base/clock.h"
#include "base/result.h"
#include "base/units.h"
#include "protocol/stage/axis.h"
#include "protocol/stage/register_map.h"

namespace gonio::drivers {

/// Counts STOPs. Every motion command carries the epoch it was decided in; the stage refuses one older than its own.
using Epoch = std::uint32_t;
/// Names one motion command, so that its acceptance is not taken from another.
using MotionToken = std::uint16_t;

/// Where to go; an axis without a value stays. In the axis' unit (deg, mm, slot).
using MotionTarget = stage::PerAxis<std::optional<double>>;

struct AxisState {
  std::int32_t counts = 0;  ///< raw, as on the wire
  double position = 0.0;    ///< deg, mm or slot
  bool moving = false;
  bool homed = false;
  bool at_limit = false;
  std::uint16_t fault = 0;
  std::uint16_t alarm = 0;  ///< the drive's own code of its fault, where it has one
};

/// What the stage latched over one exposure of the camera (exposure-active line).
struct GateRecord {
  std::uint32_t count = 0;  ///< exposures since the stage's power-up
  bool open = false;        ///< true: an exposure is under way, the rest belongs to the one before
  stage::PerAxis<std::int32_t> open_counts{};
  stage::PerAxis<std::int32_t> close_counts{};
  double monitor_mean = 0.0;
  double monitor_se = 0.0;  ///< standard error of the mean
  std::uint32_t monitor_samples = 0;
};

/// One consistent look at the stage: all of it from one transaction.
struct StageState {
  Instant at{};  ///< when the reply arrived
  std::uint32_t boot_counter = 0;
  bool moving = false;
  bool homed = false;
  bool halted = false;
  bool heartbeat_tripped = false;
  bool interlock_open = false;
  std::uint16_t fault = 0;
  Epoch epoch = 0;
  std::uint16_t stop_count = 0;
  MotionToken accepted_token = 0;
  MotionToken refused_token = 0;
  stage::Refusal refusal = stage::Refusal::None;
  stage::PerAxis<AxisState> axes{};
  stage::ShutterState source_shutter = stage::ShutterState::Closed;
  stage::ShutterState detector_shutter = stage::ShutterState::Closed;
  double monitor = 0.0;
  double lamp_temperature_c = 0.0;
  double detector_temperature_c = 0.0;
  double room_temperature_c = 0.0;
  double humidity_percent = 0.0;
  GateRecord gate{};
};

/// Where the axes stand in a look.
[[nodiscard]] inline stage::PerAxis<double> positions_of(const StageState& state) {
  stage::PerAxis<double> positions{};
  for (std::size_t a = 0; a < positions.size(); ++a) positions[a] = state.axes[a].position;
  return positions;
}

/// A move that a stage was told.
struct StartedMove {
  MotionToken token = 0;
  std::optional<StageState> seen;  ///< the stage once it was told, where one exchange did both
};

/// A goniometer stage: arms, sample azimuth, carriage, filter wheel, shutters, and the lamp monitor and sensors on its
/// bus. Nothing here waits for motion: each call is at most a few link transactions, each with a deadline. Waiting is
/// `MoveTask`'s (drivers/motion): a pure state machine that is shown `StageState`s.
/// Threads: owned by one. STOP does not pass here; it has `HaltLine`.
class Stage {
 public:
  virtual ~Stage() = default;

  /// Errors: Unreachable, TimedOut, BadReply, WrongDevice. Reconnects by itself on the next call after a failure.
  [[nodiscard]] virtual Result<StageState> read_state() = 0;

  /// Starts all named axes at once, coordinated where the configuration says so; returns when the stage has been told,
  /// not when it has accepted (`accepted_token` says). Errors: as read_state, OutOfLimits (nothing was sent),
  /// DeviceRefused.
  [[nodiscard]] virtual Result<MotionToken> start_move(const MotionTarget& target, Epoch epoch) = 0;
  /// start_move, with a look that costs no exchange of its own where the wire has one for both. `seen` shows the stage
  /// after it has accepted or refused: it is left out while the stage does neither. Errors: those of start_move.
  [[nodiscard]] virtual Result<StartedMove> start_move_and_look(const MotionTarget& target, Epoch epoch) {
    const Result<MotionToken> token = start_move(target, epoch);
    if (!token) return failure(token.error());
    return StartedMove{*token, std::nullopt};
  }
  /// Homes all axes.
  [[nodiscard]] virtual Result<MotionToken> start_homing(Epoch epoch) = 0;
  [[nodiscard]] virtual Result<void> set_shutters(bool source_open, bool detector_open) = 0;
  /// Clears the STOP latch, the heartbeat trip and faults whose cause is gone. Moves nothing.
  [[nodiscard]] virtual Result<void> reset(Epoch epoch) = 0;
};

/// The way of STOP and of the heartbeat: its own connection, its own thread.
class HaltLine {
 public:
  virtual ~HaltLine() = default;
  /// Returns when the halt is on the wire and acknowledged. Errors: Unreachable, TimedOut.
  [[nodiscard]] virtual Result<void> halt(Epoch epoch) = 0;
  /// `timeout` of zero ends the watch. Wall time.
  [[nodiscard]] virtual Result<void> watch_heartbeat(Duration timeout) = 0;
  [[nodiscard]] virtual Result<void> beat() = 0;
  /// Makes a `beat` or `watch_heartbeat` in progress give up at once, so that a halt need not wait for it. Threads:
  /// any.
  virtual void interrupt() = 0;
};

}  // namespace gonio::drivers
