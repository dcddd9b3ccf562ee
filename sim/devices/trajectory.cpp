#include "sim/devices/trajectory.h"

#include <algorithm>
#include <cmath>

namespace gonio::sim {

Trajectory Trajectory::move(double from, double to, AxisDynamics dynamics, Instant start) {
  Trajectory t(from);
  t.to_ = to;
  t.start_ = start;
  const double way = std::abs(to - from);
  const double sign = to < from ? -1.0 : 1.0;
  // The ramp ends at top speed, or half way where the way is too short for that: way = a ramp^2.
  const double ramp = std::min(dynamics.speed / dynamics.acceleration, std::sqrt(way / dynamics.acceleration));
  if (ramp <= 0.0) return t;
  const double top = dynamics.acceleration * ramp;
  t.acceleration_ = sign * dynamics.acceleration;
  t.top_speed_ = sign * top;
  t.ramp_up_s_ = ramp;
  t.ramp_down_s_ = ramp;
  t.duration_s_ = way / top + ramp;
  return t;
}

Trajectory Trajectory::brake(double position, double velocity, double acceleration, Instant start) {
  Trajectory t(position);
  t.start_ = start;
  t.acceleration_ = velocity < 0.0 ? -acceleration : acceleration;
  t.top_speed_ = velocity;
  t.ramp_down_s_ = std::abs(velocity) / acceleration;
  t.duration_s_ = t.ramp_down_s_;
  t.to_ = position + 0.5 * velocity * t.ramp_down_s_;
  return t;
}

double Trajectory::position(Instant at) const {
  const double t = in_seconds(at - start_);
  if (t <= 0.0) return from_;
  if (t >= duration_s_) return to_;
  if (t < ramp_up_s_) return from_ + 0.5 * acceleration_ * t * t;
  const double left = duration_s_ - t;
  if (left < ramp_down_s_) return to_ - 0.5 * acceleration_ * left * left;
  return from_ + top_speed_ * (t - 0.5 * ramp_up_s_);
}

double Trajectory::velocity(Instant at) const {
  const double t = in_seconds(at - start_);
  if (t <= 0.0) return ramp_up_s_ > 0.0 ? 0.0 : (t < 0.0 ? 0.0 : top_speed_);
  if (t >= duration_s_) return 0.0;
  if (t < ramp_up_s_) return acceleration_ * t;
  const double left = duration_s_ - t;
  return left < ramp_down_s_ ? acceleration_ * left : top_speed_;
}

}  // namespace gonio::sim
