#include "sim/devices/axis_model.h"

#include <algorithm>
#include <cmath>

namespace gonio::sim {
namespace {

// protocol/stage: `axis_fault`
constexpr std::uint16_t kFollowingError = 1;
constexpr std::uint16_t kLimitSwitch = 3;

}  // namespace

AxisModel::AxisModel(const AxisSpec& spec, double scale, double time_scale, double following_error_s, double position,
                     double lag)
    : spec_(spec),
      dynamics_{.speed = spec.speed * time_scale, .acceleration = spec.acceleration * time_scale * time_scale},
      scale_(scale),
      following_error_(seconds(following_error_s / time_scale)),
      path_(position),
      moved_(position + lag),
      origin_(position) {}

// One path goes one way only, so the play is taken up once: a flank pushes, or it stands where it stood.
double AxisModel::lag(Instant t) const {
  if (spec_.backlash == 0.0) return 0.0;
  const double half_play = 0.5 * spec_.backlash;
  return std::clamp(moved_ - position(t), -half_play, half_play);
}

void AxisModel::follow(Trajectory path, Instant now) {
  moved_ = position(now) + lag(now);
  path_ = path;
}

std::int32_t AxisModel::counts(Instant t) const {
  return static_cast<std::int32_t>(std::lround((position(t) - origin_) / scale_));
}

bool AxisModel::is_within_limits(double position) const {
  const double half_count = 0.5 * std::abs(scale_);  // a limit that lies between two counts is reached by its nearest
  return position >= spec_.low - half_count && position <= spec_.high + half_count;
}

void AxisModel::start(double target, const AxisDynamics& dynamics, std::uint64_t move, Instant now) {
  last_move_ = move;
  const double here = position(now);
  if (is_blocked_) {
    if (here != target) fault_due_ = now + following_error_;
    return;
  }
  follow(Trajectory::move(here, target, dynamics, now), now);
}

void AxisModel::move_to(double target, std::uint64_t move, Instant now) {
  start(target, dynamics_, move, now);
}

void AxisModel::move_to(double target, const AxisDynamics& wanted, std::uint64_t move, Instant now) {
  start(target,
        {.speed = std::min(wanted.speed, dynamics_.speed),
         .acceleration = std::min(wanted.acceleration, dynamics_.acceleration)},
        move, now);
}

void AxisModel::power_cycle(Instant now) {
  const double here = position(now);
  follow(Trajectory(here), now);
  origin_ = here;
  is_homed_ = false;
  homing_end_.reset();
  fault_due_.reset();
  fault_ = 0;
  ++boots_;
}

void AxisModel::home(std::uint64_t move, Instant now) {
  constexpr double kCarefully = 0.5;
  is_homed_ = false;
  start(std::clamp(0.0, spec_.low, spec_.high),
        {.speed = dynamics_.speed * kCarefully, .acceleration = dynamics_.acceleration}, move, now);
  if (!fault_due_) homing_end_ = path_.end();
}

void AxisModel::brake(Instant now) {
  homing_end_.reset();
  fault_due_.reset();
  if (!path_.is_moving(now)) return;
  follow(Trajectory::brake(position(now), path_.velocity(now), dynamics_.acceleration, now), now);
}

void AxisModel::block(Instant now) {
  is_blocked_ = true;
  if (!path_.is_moving(now)) return;
  homing_end_.reset();
  fault_due_ = now + following_error_;
  follow(Trajectory(position(now)), now);
}

void AxisModel::lose_steps(double by, Instant now) {
  if (!path_.is_moving(now)) return;
  const double here = position(now);
  const double forward = path_.destination() < here ? -1.0 : 1.0;
  path_ = Trajectory::move(here, path_.destination() - forward * by, dynamics_, now);
}

void AxisModel::hit_limit(Instant now) {
  brake(now);
  fault_ = kLimitSwitch;
}

void AxisModel::clear_fault() {
  if (!is_blocked_) fault_ = 0;
}

std::optional<Instant> AxisModel::next_event() const {
  if (fault_due_ && homing_end_) return std::min(*fault_due_, *homing_end_);
  return fault_due_ ? fault_due_ : homing_end_;
}

bool AxisModel::advance_to(Instant now) {
  if (homing_end_ && *homing_end_ <= now) {
    homing_end_.reset();
    origin_ = 0.0;
    is_homed_ = true;
  }
  if (!fault_due_ || *fault_due_ > now) return false;
  fault_due_.reset();
  fault_ = kFollowingError;
  return true;
}

}  // namespace gonio::sim
