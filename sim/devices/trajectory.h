#pragma once

#include "base/clock.h"

namespace gonio::sim {

/// How fast an axis may go; its own unit per second of wall time, both > 0.
struct AxisDynamics {
  double speed = 1.0;
  double acceleration = 1.0;
};

/// One axis' motion in closed form: trapezoidal in speed (triangular when the way is short), exact at any time, without
/// ticks. Value type. Before its start it stands at `from`, after its end at `to`.
class Trajectory {
 public:
  /// Standing for ever.
  explicit Trajectory(double at = 0.0) : from_(at), to_(at) {}

  /// From rest to rest.
  [[nodiscard]] static Trajectory move(double from, double to, AxisDynamics dynamics, Instant start);
  /// Braking from `position` and `velocity` at `acceleration` until it stands.
  [[nodiscard]] static Trajectory brake(double position, double velocity, double acceleration, Instant start);

  [[nodiscard]] double position(Instant t) const;
  [[nodiscard]] double velocity(Instant t) const;
  [[nodiscard]] double destination() const { return to_; }
  [[nodiscard]] Instant end() const { return start_ + seconds(duration_s_); }
  [[nodiscard]] bool is_moving(Instant t) const { return t >= start_ && t < end(); }

 private:
  // Three phases: ramp_s_ at +a, then even speed, then ramp down. A brake is the last phase alone.
  double from_ = 0.0;
  double to_ = 0.0;
  double acceleration_ = 0.0;  ///< signed, along the motion
  double ramp_up_s_ = 0.0;
  double ramp_down_s_ = 0.0;
  double duration_s_ = 0.0;
  double top_speed_ = 0.0;  ///< signed
  Instant start_{};
};

}  // namespace gonio::sim
