#include "sim/devices/drive_face.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

namespace gonio::sim {
namespace {

// Bits of the control and the status word: CiA 402-2, 8.4.1 and 8.4.2.
constexpr std::int64_t kEnableVoltage = 0x02;
constexpr std::int64_t kNoQuickStop = 0x04;
constexpr std::int64_t kCommandBits = 0x0F;
constexpr std::int64_t kShutdown = 0x06;
constexpr std::int64_t kSwitchOn = 0x07;
constexpr std::int64_t kEnableOperation = 0x0F;
constexpr std::int64_t kStart = 0x10;
constexpr std::int64_t kFaultReset = 0x80;
constexpr std::array<std::int64_t, 6> kStateBits{0x40, 0x21, 0x23, 0x27, 0x07, 0x08};  // in the order of State
constexpr std::int64_t kVoltageEnabled = 0x10;
constexpr std::int64_t kRemote = 0x200;
constexpr std::int64_t kTargetReached = 0x400;
constexpr std::int64_t kSetPointAcknowledge = 0x1000;
constexpr std::int64_t kMotionEnded = 0x4000;  // the vendor's: x_end, ref_ok
constexpr std::int64_t kReferenced = 0x8000;
constexpr std::int64_t kHomingMode = 6;

// Error codes of CiA 301, 7.2.7.1, and of CiA 402-2; the bits of `signals` are the vendor's.
constexpr std::int64_t kLifeGuard = 0x8130;
constexpr std::int64_t kFollowingErrorCode = 0x8611;
constexpr std::int64_t kOutOfRange = 0x8500;
constexpr std::int64_t kRangeSignal = 0x04;
constexpr std::int64_t kLineSignal = 0x20;
constexpr std::int64_t kFollowingSignal = 0x100;

constexpr std::int64_t kPowerUpSpeed = 60;
constexpr std::int64_t kPowerUpAcceleration = 600;

bool is_shown(std::string_view name) {
  return name == "status" || name == "position" || name == "alarm" || name == "signals";
}

}  // namespace

DriveFace::DriveFace(Instrument& instrument, stage::Axis axis, const stage::DriveMap& map, const stage::DriveAxis& spec)
    : instrument_(instrument), axis_(axis), map_(map), spec_(spec) {
  for (const auto& [name, reg] : map_.registers) bank_.add(reg, !is_shown(name));
  power_up();
}

void DriveFace::power_up() {
  bank_.clear();
  put("speed", kPowerUpSpeed);
  put("acceleration", kPowerUpAcceleration);
  put("low_limit", std::numeric_limits<std::int32_t>::min());
  put("high_limit", std::numeric_limits<std::int32_t>::max());
  state_ = State::SwitchOnDisabled;
  control_ = alarm_ = signals_ = 0;
  boots_ = stage().boot_counter();
  axis_boots_ = axis().boots();
}

std::int64_t DriveFace::value(std::string_view name, std::int64_t otherwise) const {
  const stage::Register* reg = map_.find(name);
  return reg == nullptr ? otherwise : bank_.get(*reg);
}

void DriveFace::put(std::string_view name, std::int64_t value) {
  if (const stage::Register* reg = map_.find(name)) bank_.set(*reg, value);
}

bool DriveFace::wrote(std::string_view name, std::uint16_t first, std::size_t count) const {
  const stage::Register* reg = map_.find(name);
  return reg != nullptr && is_covered(*reg, first, count);
}

// What has happened since the last request.
void DriveFace::begin(Instant now) {
  instrument_.advance_to(now);
  if (boots_ != stage().boot_counter() || axis_boots_ != axis().boots()) power_up();
  if (state_ != State::Fault && stage().is_drive_tripped(axis_)) fail(kLifeGuard, kLineSignal, now);
  if (state_ != State::Fault && axis().fault() != 0) fail(kFollowingErrorCode, kFollowingSignal, now);
  if (state_ != State::Fault && stage().is_interlock_open()) state_ = State::SwitchOnDisabled;
  stage().feed_drive(axis_, now);
}

void DriveFace::fail(std::int64_t alarm, std::int64_t signals, Instant now) {
  stage().brake_drive(axis_, now);
  state_ = State::Fault;
  alarm_ = alarm;
  signals_ |= signals;
}

std::int64_t DriveFace::status(Instant now) const {
  std::int64_t word = kStateBits[static_cast<std::size_t>(state_)] | kVoltageEnabled | kRemote;
  if (!axis().is_moving(now)) word |= kTargetReached | kMotionEnded;
  if ((control_ & kStart) != 0) word |= kSetPointAcknowledge;
  if (axis().is_homed()) word |= kReferenced;
  return word;
}

void DriveFace::show(Instant now) {
  put("status", status(now));
  put("position", axis().counts(now));
  put("alarm", alarm_);
  put("signals", signals_);
}

std::optional<ModbusException> DriveFace::read(std::uint16_t first, std::span<std::uint16_t> out, Instant now) {
  begin(now);
  show(now);
  return bank_.read(first, out);
}

std::optional<ModbusException> DriveFace::write(std::uint16_t first, std::span<const std::uint16_t> values,
                                                Instant now) {
  begin(now);
  if (const auto refused = bank_.write(first, values)) return refused;
  if (wrote("watchdog", first, values.size())) {
    const double timeout_s = static_cast<double>(value("watchdog", 0)) * map_.watchdog_s_per_count;
    stage().watch_drive(axis_, seconds(timeout_s), now);
  }
  if (wrote("control", first, values.size())) obey(now);
  return std::nullopt;
}

void DriveFace::obey(Instant now) {
  const std::int64_t control = value("control", 0);
  const std::int64_t before = control_;
  control_ = control;
  change_state(control, before, now);
  const bool is_edge = (control & kStart) != 0 && (before & kStart) == 0;
  if (is_edge && state_ == State::OperationEnabled && !stage().is_interlock_open()) start(now);
}

void DriveFace::change_state(std::int64_t control, std::int64_t before, Instant now) {
  if (state_ == State::Fault) {
    if ((control & kFaultReset) == 0 || (before & kFaultReset) != 0) return;
    if (!stage().clear_drive(axis_, now)) return;  // its cause is still there
    state_ = State::SwitchOnDisabled;
    alarm_ = signals_ = 0;
    return;
  }
  if ((control & kEnableVoltage) == 0) {
    stage().brake_drive(axis_, now);
    state_ = State::SwitchOnDisabled;
  } else if ((control & kNoQuickStop) == 0) {
    if (state_ == State::OperationEnabled) stage().brake_drive(axis_, now);
    state_ =
        state_ == State::OperationEnabled || state_ == State::QuickStop ? State::QuickStop : State::SwitchOnDisabled;
  } else if ((control & kSwitchOn) == kShutdown) {
    if (state_ == State::OperationEnabled) stage().brake_drive(axis_, now);
    if (state_ != State::QuickStop) state_ = State::ReadyToSwitchOn;
  } else if ((control & kCommandBits) == kSwitchOn) {
    if (state_ == State::OperationEnabled) stage().brake_drive(axis_, now);
    if (state_ != State::QuickStop && state_ != State::SwitchOnDisabled) state_ = State::SwitchedOn;
  } else if ((control & kCommandBits) == kEnableOperation) {
    if (state_ == State::SwitchedOn || state_ == State::QuickStop) state_ = State::OperationEnabled;
  }
}

void DriveFace::start(Instant now) {
  if (value("mode", 0) == kHomingMode) {
    stage().home_drive(axis_, now);
    return instrument_.note_motion(now, axis_);
  }
  const std::int64_t target = value("target", 0);
  if (target < value("low_limit", target) || target > value("high_limit", target)) {
    return fail(kOutOfRange, kRangeSignal, now);
  }
  const double speed = static_cast<double>(value("speed", 0)) * spec_.speed_scale;
  const double acceleration = static_cast<double>(value("acceleration", 0)) * spec_.acceleration_scale;
  stage().drive_to(axis_, target, {.speed = speed, .acceleration = acceleration}, now);
  instrument_.note_motion(now, axis_);
}

}  // namespace gonio::sim
