#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "protocol/stage/drive_stage_map.h"
#include "sim/devices/instrument.h"
#include "sim/devices/register_bank.h"
#include "sim/devices/register_face.h"

namespace gonio::sim {

/// A servo drive that moves one axis of the instrument: the state machine and the profile position and homing modes of
/// CiA 402-2, at the addresses of a map. It knows the registers by their names there: control, status, mode, target,
/// position, speed, acceleration, low_limit, high_limit, watchdog, alarm, signals; others only keep what is written.
///
/// Any request feeds its watchdog. It forgets everything when its axis or the whole stage loses power. It brakes and
/// falls into Fault by a following error, a missed watchdog (alarm 8130h), a target outside of its soft limits; while
/// the interlock is open it has no power to move. Threads: one at a time, as the instrument.
class DriveFace final : public RegisterFace {
 public:
  /// `instrument` and `map` must outlive it; `spec` says what the drive's counts mean.
  DriveFace(Instrument& instrument, stage::Axis axis, const stage::DriveMap& map, const stage::DriveAxis& spec);

  std::optional<ModbusException> read(std::uint16_t first, std::span<std::uint16_t> out, Instant now) override;
  std::optional<ModbusException> write(std::uint16_t first, std::span<const std::uint16_t> values,
                                       Instant now) override;
  bool has_input_registers() const override { return map_.reads == stage::ReadFunction::Input; }

 private:
  enum class State : std::uint8_t { SwitchOnDisabled, ReadyToSwitchOn, SwitchedOn, OperationEnabled, QuickStop, Fault };

  void begin(Instant now);
  void power_up();
  void obey(Instant now);
  void change_state(std::int64_t control, std::int64_t before, Instant now);
  void start(Instant now);
  void fail(std::int64_t alarm, std::int64_t signals, Instant now);
  void show(Instant now);
  [[nodiscard]] std::int64_t status(Instant now) const;
  [[nodiscard]] std::int64_t value(std::string_view name, std::int64_t otherwise) const;
  void put(std::string_view name, std::int64_t value);
  [[nodiscard]] bool wrote(std::string_view name, std::uint16_t first, std::size_t count) const;
  [[nodiscard]] StageModel& stage() { return instrument_.stage(); }
  [[nodiscard]] const AxisModel& axis() const { return instrument_.stage().axis(axis_); }

  Instrument& instrument_;
  stage::Axis axis_;
  const stage::DriveMap& map_;
  stage::DriveAxis spec_;
  RegisterBank bank_;
  State state_ = State::SwitchOnDisabled;
  std::int64_t control_ = 0;  ///< as it was before the write in hand
  std::int64_t alarm_ = 0;
  std::int64_t signals_ = 0;
  std::uint32_t boots_ = 0;  ///< of the stage and of the axis, when these registers were filled
  std::uint32_t axis_boots_ = 0;
};

}  // namespace gonio::sim
