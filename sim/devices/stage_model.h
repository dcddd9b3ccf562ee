#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "protocol/stage/axis.h"
#include "protocol/stage/register_map.h"
#include "sim/devices/axis_model.h"
#include "sim/optics/lamp.h"
#include "sim/scene/scene.h"

namespace gonio::sim {

/// What a stage keeps without power.
struct StageMemory {
  std::uint32_t boot_counter = 0;                   ///< before this power-up
  std::optional<stage::PerAxis<double>> positions;  ///< none: every axis stands at its home
  stage::PerAxis<double> lags{};                    ///< of what is moved behind its motor: backlash
  std::uint64_t moves = 0;                          ///< ever made: numbers the draws of the repeat errors
};

/// The motion block as written.
struct MotionCommand {
  std::uint32_t epoch = 0;
  std::uint16_t token = 0;
  std::uint16_t mask = 0;
  stage::PerAxis<std::int64_t> targets{};  ///< counts
  std::uint16_t command = 0;
};

/// What the stage latched over one exposure. While `is_open`, all but `count` belongs to the exposure before.
struct GateLatch {
  std::uint32_t count = 0;
  bool is_open = false;
  stage::PerAxis<std::int32_t> open_counts{};
  stage::PerAxis<std::int32_t> close_counts{};
  MonitorReading monitor;
};

/// How the motion was last commanded, and with what answer.
struct MotionAnswer {
  std::uint16_t accepted_token = 0;
  std::uint16_t refused_token = 0;
  stage::Refusal refusal = stage::Refusal::None;
};

/// A shutter that takes time.
struct ShutterModel {
  bool wants_open = false;
  Instant done{};
  [[nodiscard]] stage::ShutterState state(Instant t) const;
};

/// The stage's controller and mechanics, as protocol/stage/README.md describes them, without wires: time is an argument
/// (wall time, never back), every call first needs `advance_to` up to its `now`. Threads: one.
class StageModel {
 public:
  StageModel(const StageSpec& spec, double time_scale, const StageMemory& memory, Instant power_up);

  /// The next instant at which something happens by itself: homing ends, a heartbeat is missed, a blocked axis is
  /// noticed.
  [[nodiscard]] std::optional<Instant> next_event() const;
  /// Lets happen what is due up to `now`.
  void advance_to(Instant now);

  /// Acts, or refuses: see `motion_answer`.
  void command_motion(const MotionCommand& command, Instant now);
  void halt(std::uint32_t epoch, Instant now);
  /// False: refused, the epoch is too old.
  [[nodiscard]] bool reset(std::uint32_t epoch, Instant now);
  void set_shutters(bool source_open, bool detector_open, Instant now);
  void beat(std::uint16_t value, Instant now);
  void watch_heartbeat(std::uint16_t timeout_ms, Instant now);

  /// The camera's exposure-active line.
  void open_gate(Instant now);
  void close_gate(Instant now, const MonitorReading& monitor);

  void block_axis(stage::Axis axis, Instant now) { axes_[stage::index_of(axis)].block(now); }
  void slip_encoder(stage::Axis axis, double by) { axes_[stage::index_of(axis)].slip_encoder(by); }
  void lose_steps(stage::Axis axis, double by, Instant now) { axes_[stage::index_of(axis)].lose_steps(by, now); }
  void hit_limit(stage::Axis axis, Instant now);
  void free_axis(stage::Axis axis) { axes_[stage::index_of(axis)].free(); }
  void set_interlock(bool is_open, Instant now);

  // As separate drives (stage_model_drives.cpp): each axis is told, watched and cleared by itself.
  /// To a position in counts, no faster than `wanted` (wall time) and than the axis can.
  void drive_to(stage::Axis axis, std::int64_t counts, const AxisDynamics& wanted, Instant now);
  void home_drive(stage::Axis axis, Instant now);
  void brake_drive(stage::Axis axis, Instant now);
  /// A drive that hears nothing for `timeout` brakes its axis, and is tripped; zero ends the watch.
  void watch_drive(stage::Axis axis, Duration timeout, Instant now);
  void feed_drive(stage::Axis axis, Instant now);
  [[nodiscard]] bool is_drive_tripped(stage::Axis axis) const {
    return drive_watches_[stage::index_of(axis)].is_tripped;
  }
  /// Clears trip and fault; false: the fault's cause is still there.
  [[nodiscard]] bool clear_drive(stage::Axis axis, Instant now);
  /// One drive loses its power and gets it back: its home and its watch are gone, the axis stands where it was.
  void power_cycle_axis(stage::Axis axis, Instant now);

  [[nodiscard]] const AxisModel& axis(stage::Axis a) const { return axes_[stage::index_of(a)]; }
  [[nodiscard]] bool is_moving(Instant t) const;
  [[nodiscard]] bool is_homed() const;
  [[nodiscard]] std::uint16_t status_word(Instant t) const;
  [[nodiscard]] std::uint16_t fault() const { return fault_; }
  [[nodiscard]] std::uint32_t boot_counter() const { return boot_counter_; }
  [[nodiscard]] std::uint32_t epoch() const { return epoch_; }
  [[nodiscard]] std::uint16_t stop_count() const { return stop_count_; }
  [[nodiscard]] std::uint16_t heartbeat_seen() const { return heartbeat_seen_; }
  [[nodiscard]] std::uint16_t heartbeat_timeout_ms() const { return heartbeat_timeout_ms_; }
  [[nodiscard]] const MotionAnswer& motion_answer() const { return answer_; }
  [[nodiscard]] const ShutterModel& source_shutter() const { return source_shutter_; }
  [[nodiscard]] const ShutterModel& detector_shutter() const { return detector_shutter_; }
  [[nodiscard]] const GateLatch& gate() const { return gate_; }
  /// The number of the last move of any axis.
  [[nodiscard]] std::uint64_t moves() const { return moves_; }
  /// Accepted since power-up: what has made something move.
  [[nodiscard]] std::uint32_t motion_commands() const { return motion_commands_; }
  [[nodiscard]] std::uint32_t shutter_commands() const { return shutter_commands_; }
  [[nodiscard]] bool is_halted() const { return is_halted_; }
  [[nodiscard]] bool is_tripped() const { return is_tripped_; }
  [[nodiscard]] bool is_interlock_open() const { return is_interlock_open_; }
  [[nodiscard]] StageMemory memory(Instant now) const;

 private:
  struct DriveWatch {
    Duration timeout{};
    Instant last_word{};
    bool is_tripped = false;
  };
  [[nodiscard]] std::optional<Instant> drive_watch_due(stage::Axis axis) const;
  void trip_drives(Instant now);
  [[nodiscard]] stage::Refusal judge(const MotionCommand& command, Instant now) const;
  void move_each(const MotionCommand& command, Instant now);
  void move_together(const MotionCommand& command, Instant now);
  [[nodiscard]] std::optional<Instant> heartbeat_due() const;
  [[nodiscard]] stage::PerAxis<std::int32_t> latched(Instant now) const;
  void brake_all(Instant now);

  std::vector<AxisModel> axes_;
  Duration shutter_time_;
  std::uint32_t boot_counter_;
  std::uint64_t moves_;
  std::uint32_t epoch_ = 0;
  std::uint16_t stop_count_ = 0;
  std::uint16_t fault_ = 0;
  bool is_halted_ = false;
  bool is_tripped_ = false;
  bool is_interlock_open_ = false;
  MotionAnswer answer_;
  std::uint16_t heartbeat_seen_ = 0;
  std::uint16_t heartbeat_timeout_ms_ = 0;
  Instant last_beat_;
  stage::PerAxis<DriveWatch> drive_watches_{};
  ShutterModel source_shutter_;
  ShutterModel detector_shutter_;
  std::uint32_t motion_commands_ = 0;
  std::uint32_t shutter_commands_ = 0;
  GateLatch gate_;
  stage::PerAxis<std::int32_t> pending_open_{};  ///< of the exposure under way; shown when it has closed
};

}  // namespace gonio::sim
