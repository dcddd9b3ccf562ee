#pragma once

#include <cstdint>
#include <optional>

#include "base/clock.h"
#include "sim/devices/trajectory.h"
#include "sim/scene/scene.h"

namespace gonio::sim {

/// One axis of the stage with its encoder and drive. Positions in the axis' own unit; times are wall time and must not
/// go back. The encoder counts from where it was switched on until homing has found the true zero.
class AxisModel {
 public:
  /// `spec` in scene time; `scale` the unit per encoder count.
  /// What is moved stands `lag` from the motor.
  AxisModel(const AxisSpec& spec, double scale, double time_scale, double following_error_s, double position,
            double lag = 0.0);

  void move_to(double target, std::uint64_t move, Instant now);
  /// The same, no faster than `wanted` (wall time).
  void move_to(double target, const AxisDynamics& wanted, std::uint64_t move, Instant now);
  /// Looks for the zero, at half speed; homed once it is there.
  void home(std::uint64_t move, Instant now);
  void brake(Instant now);
  /// Holds the axis where it stands: the drive notices after the following-error time, if the axis should be moving.
  void block(Instant now);
  void free() { is_blocked_ = false; }
  /// Its drive loses power and gets it back: stands, and counts from here until homing.
  void power_cycle(Instant now);
  /// How often that has happened.
  [[nodiscard]] std::uint32_t boots() const { return boots_; }
  /// The encoder slips: from now on it shows `by` more, until homing finds the zero again. The axis stays where it is.
  void slip_encoder(double by) { origin_ -= by; }
  /// The move under way ends `by` short of where it was to go (beyond it, for a negative one).
  void lose_steps(double by, Instant now);
  /// A limit switch closes.
  void hit_limit(Instant now);
  /// When the motion under way, or the last one, ends.
  [[nodiscard]] Instant motion_end() const { return path_.end(); }
  void clear_fault();

  /// The next instant at which something happens by itself: homing ends, a following error is noticed.
  [[nodiscard]] std::optional<Instant> next_event() const;
  /// True when a fault arose at this very call.
  bool advance_to(Instant now);

  [[nodiscard]] double position(Instant t) const { return path_.position(t); }
  /// How far what is moved stands from its motor: within half of the play, on the side that the last motion left.
  [[nodiscard]] double lag(Instant t) const;
  [[nodiscard]] std::int32_t counts(Instant t) const;
  [[nodiscard]] double destination() const { return path_.destination(); }
  [[nodiscard]] double target_of_counts(std::int64_t counts) const {
    return origin_ + static_cast<double>(counts) * scale_;
  }
  /// Moving, or trying to.
  [[nodiscard]] bool is_moving(Instant t) const { return path_.is_moving(t) || fault_due_.has_value(); }
  [[nodiscard]] bool is_homed() const { return is_homed_; }
  [[nodiscard]] bool is_within_limits(double position) const;
  [[nodiscard]] std::uint16_t fault() const { return fault_; }
  [[nodiscard]] std::uint64_t last_move() const { return last_move_; }
  [[nodiscard]] const AxisSpec& spec() const { return spec_; }
  /// What it can do, per wall time.
  [[nodiscard]] const AxisDynamics& dynamics() const { return dynamics_; }

 private:
  void start(double target, const AxisDynamics& dynamics, std::uint64_t move, Instant now);
  void follow(Trajectory path, Instant now);

  AxisSpec spec_;
  AxisDynamics dynamics_;  ///< wall time
  double scale_;
  Duration following_error_;
  Trajectory path_;
  double moved_;   ///< where what is moved stood when `path_` began
  double origin_;  ///< position at zero counts
  bool is_homed_ = false;
  std::optional<Instant> homing_end_;
  bool is_blocked_ = false;
  std::optional<Instant> fault_due_;
  std::uint16_t fault_ = 0;
  std::uint64_t last_move_ = 0;
  std::uint32_t boots_ = 0;
};

}  // namespace gonio::sim
