#include "sim/devices/stage_face.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gonio::sim {

using stage::Axis;
using stage::AxisBit;
using stage::AxisField;
using stage::Field;
using stage::Register;

namespace {

constexpr std::array kWritableFields{Field::Token,
                                     Field::HeartbeatTimeoutMs,
                                     Field::Heartbeat,
                                     Field::HaltEpoch,
                                     Field::HaltKey,
                                     Field::ResetEpoch,
                                     Field::ResetKey,
                                     Field::MotionEpoch,
                                     Field::SourceShutterCommand,
                                     Field::DetectorShutterCommand,
                                     Field::MotionToken,
                                     Field::MotionMask,
                                     Field::MotionCommand};

void mark(std::vector<bool>& marks, const Register& reg) {
  for (unsigned k = 0; k < reg.words; ++k) marks[std::size_t{reg.address} + k] = true;
}

std::size_t end_of(const Register& reg) {
  return std::size_t{reg.address} + reg.words;
}

// The nearest count that the register can hold.
std::int64_t scaled(double value, double scale, const Register& reg) {
  const double most = std::ldexp(1.0, reg.words * 16 - (reg.is_signed ? 1 : 0)) - 1.0;
  return static_cast<std::int64_t>(std::llround(std::clamp(value / scale, reg.is_signed ? -most : 0.0, most)));
}

}  // namespace

StageFace::StageFace(Instrument& instrument) : instrument_(instrument), map_(instrument.scene().stage.registers) {
  std::size_t size = 0;
  for (const Register& reg : map_.fields) size = std::max(size, end_of(reg));
  for (const auto& axis : map_.axes) {
    for (const Register& reg : axis) size = std::max(size, end_of(reg));
  }
  words_.assign(size, 0);
  is_register_.assign(size, false);
  is_writable_.assign(size, false);
  for (const Register& reg : map_.fields) mark(is_register_, reg);
  for (const auto& axis : map_.axes) {
    for (const Register& reg : axis) mark(is_register_, reg);
  }
  for (const Field field : kWritableFields) mark(is_writable_, map_.at(field));
  for (const Axis axis : stage::kAllAxes) mark(is_writable_, map_.at(axis, AxisField::Target));
}

bool StageFace::covers(std::uint16_t first, std::size_t count, const Register& reg) const {
  return reg.address >= first && end_of(reg) <= std::size_t{first} + count;
}

std::int64_t StageFace::value(Field field) const {
  return stage::decode(words_, 0, map_.at(field));
}

// A counter may outgrow its register: it wraps, as a counter does.
void StageFace::put(Field field, std::int64_t value) {
  const Register& reg = map_.at(field);
  const auto mask = (std::int64_t{1} << (reg.words * 16)) - 1;
  stage::encode(words_, 0, reg, reg.is_signed ? value : (value & mask));
}

void StageFace::put(Axis axis, AxisField field, std::int64_t value) {
  stage::encode(words_, 0, map_.at(axis, field), value);
}

void StageFace::refresh(Instant now) {
  const StageModel& stage = instrument_.stage();
  const EnvironmentSpec& environment = instrument_.scene().environment;
  put(Field::Identity, stage::kIdentity);
  put(Field::MapVersion, stage::kMapVersion);
  put(Field::BootCounter, stage.boot_counter());
  put(Field::Status, stage.status_word(now));
  put(Field::Fault, stage.fault());
  put(Field::Epoch, stage.epoch());
  put(Field::StopCount, stage.stop_count());
  put(Field::AcceptedToken, stage.motion_answer().accepted_token);
  put(Field::RefusedToken, stage.motion_answer().refused_token);
  put(Field::Refusal, static_cast<std::int64_t>(stage.motion_answer().refusal));
  put(Field::HeartbeatSeen, stage.heartbeat_seen());
  put(Field::HeartbeatTimeoutMs, stage.heartbeat_timeout_ms());
  put(Field::SourceShutter, static_cast<std::int64_t>(stage.source_shutter().state(now)));
  put(Field::DetectorShutter, static_cast<std::int64_t>(stage.detector_shutter().state(now)));
  put(Field::Monitor, scaled(instrument_.monitor_now(now), map_.monitor_scale, map_.at(Field::Monitor)));
  const auto temperature = [&](Field field, Temperature t) {
    put(field, scaled(in_celsius(t), map_.temperature_scale_c, map_.at(field)));
  };
  temperature(Field::LampTemperature, environment.lamp);
  temperature(Field::DetectorTemperature, instrument_.detector_temperature(now));
  temperature(Field::RoomTemperature, environment.room);
  put(Field::Humidity, scaled(environment.humidity_percent, map_.humidity_scale_percent, map_.at(Field::Humidity)));
  refresh_gate();
  refresh_axes(now);
}

void StageFace::refresh_gate() {
  const GateLatch& gate = instrument_.stage().gate();
  put(Field::GateCount, gate.count);
  put(Field::GateState, gate.is_open ? 1 : 0);
  put(Field::GateMonitorMean, scaled(gate.monitor.mean, map_.monitor_scale, map_.at(Field::GateMonitorMean)));
  put(Field::GateMonitorSe, scaled(gate.monitor.standard_error, map_.monitor_scale, map_.at(Field::GateMonitorSe)));
  put(Field::GateMonitorSamples, gate.monitor.samples);
  for (const Axis axis : stage::kAllAxes) {
    put(axis, AxisField::GateOpenEncoder, gate.open_counts[stage::index_of(axis)]);
    put(axis, AxisField::GateCloseEncoder, gate.close_counts[stage::index_of(axis)]);
  }
}

void StageFace::refresh_axes(Instant now) {
  for (const Axis a : stage::kAllAxes) {
    const AxisModel& axis = instrument_.stage().axis(a);
    const double position = axis.position(now);
    unsigned status = 0;
    if (axis.is_moving(now)) status |= stage::bit(AxisBit::Moving);
    if (axis.is_homed()) status |= stage::bit(AxisBit::Homed);
    // The switches stand just outside of the soft limits.
    if (position < axis.spec().low - axis.spec().window) status |= stage::bit(AxisBit::AtLowLimit);
    if (position > axis.spec().high + axis.spec().window) status |= stage::bit(AxisBit::AtHighLimit);
    put(a, AxisField::Encoder, axis.counts(now));
    put(a, AxisField::Status, status);
    put(a, AxisField::Fault, axis.fault());
  }
}

std::optional<ModbusException> StageFace::read(std::uint16_t first, std::span<std::uint16_t> out, Instant now) {
  if (std::size_t{first} + out.size() > words_.size()) return ModbusException::IllegalAddress;
  instrument_.advance_to(now);
  refresh(now);
  std::copy_n(words_.begin() + first, out.size(), out.begin());
  return std::nullopt;
}

std::optional<ModbusException> StageFace::write(std::uint16_t first, std::span<const std::uint16_t> values,
                                                Instant now) {
  if (std::size_t{first} + values.size() > words_.size()) return ModbusException::IllegalAddress;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!is_writable_[first + k]) return ModbusException::IllegalAddress;
  }
  instrument_.advance_to(now);
  std::ranges::copy(values, words_.begin() + first);
  return act(first, values.size(), now);
}

MotionCommand StageFace::motion_command() const {
  MotionCommand command{.epoch = static_cast<std::uint32_t>(value(Field::MotionEpoch)),
                        .token = static_cast<std::uint16_t>(value(Field::MotionToken)),
                        .mask = static_cast<std::uint16_t>(value(Field::MotionMask)),
                        .command = static_cast<std::uint16_t>(value(Field::MotionCommand))};
  for (const Axis axis : stage::kAllAxes) {
    command.targets[stage::index_of(axis)] = stage::decode(words_, 0, map_.at(axis, AxisField::Target));
  }
  return command;
}

std::optional<ModbusException> StageFace::act(std::uint16_t first, std::size_t count, Instant now) {
  const auto wrote = [&](Field field) { return covers(first, count, map_.at(field)); };
  StageModel& stage = instrument_.stage();
  if (wrote(Field::HaltKey)) {
    if (value(Field::HaltKey) != stage::kHaltKey) return ModbusException::IllegalValue;
    stage.halt(static_cast<std::uint32_t>(value(Field::HaltEpoch)), now);
  }
  if (wrote(Field::ResetKey)) {
    if (value(Field::ResetKey) != stage::kResetKey) return ModbusException::IllegalValue;
    if (!stage.reset(static_cast<std::uint32_t>(value(Field::ResetEpoch)), now)) return ModbusException::IllegalValue;
  }
  if (wrote(Field::Heartbeat)) stage.beat(static_cast<std::uint16_t>(value(Field::Heartbeat)), now);
  if (wrote(Field::HeartbeatTimeoutMs)) {
    stage.watch_heartbeat(static_cast<std::uint16_t>(value(Field::HeartbeatTimeoutMs)), now);
  }
  if (wrote(Field::SourceShutterCommand) || wrote(Field::DetectorShutterCommand)) {
    stage.set_shutters(value(Field::SourceShutterCommand) == 1, value(Field::DetectorShutterCommand) == 1, now);
  }
  if (wrote(Field::MotionCommand)) {
    const std::uint32_t before = stage.motion_commands();
    stage.command_motion(motion_command(), now);
    if (stage.motion_commands() != before) instrument_.note_motion(now);
  }
  return std::nullopt;
}

}  // namespace gonio::sim
