#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "base/toml_reader.h"
#include "protocol/stage/axis.h"

namespace gonio::stage {

/// Where one value lives: its first holding register (from 0), how many 16-bit words, sign and word order.
struct Register {
  std::uint16_t address = 0;
  std::uint8_t words = 1;  ///< 1 or 2
  bool is_signed = false;
  bool low_word_first = false;
  friend bool operator==(const Register&, const Register&) = default;
};

/// The values of the stage as a whole. The page beside this header says what each means.
enum class Field : std::uint8_t {
  Token,
  Identity,
  MapVersion,
  BootCounter,
  Status,
  Fault,
  Epoch,
  StopCount,
  AcceptedToken,
  RefusedToken,
  Refusal,
  HeartbeatSeen,
  HeartbeatTimeoutMs,
  SourceShutter,
  DetectorShutter,
  Monitor,
  LampTemperature,
  DetectorTemperature,
  RoomTemperature,
  Humidity,
  GateCount,
  GateState,
  GateMonitorMean,
  GateMonitorSe,
  GateMonitorSamples,
  Heartbeat,
  HaltEpoch,
  HaltKey,
  ResetEpoch,
  ResetKey,
  SourceShutterCommand,
  DetectorShutterCommand,
  MotionEpoch,
  MotionToken,
  MotionMask,
  MotionCommand,
};
inline constexpr std::size_t kFieldCount = static_cast<std::size_t>(Field::MotionCommand) + 1;

/// The values that each axis has.
enum class AxisField : std::uint8_t { Encoder, Status, Fault, GateOpenEncoder, GateCloseEncoder, Target };
inline constexpr std::size_t kAxisFieldCount = static_cast<std::size_t>(AxisField::Target) + 1;

/// A contiguous run of registers that is read or written in one transaction.
struct Block {
  std::uint16_t first = 0;
  std::uint16_t count = 0;
  friend bool operator==(const Block&, const Block&) = default;
};

/// The whole map, as data. Scales turn counts into values: position = offset + counts * scale, per axis.
struct RegisterMap {
  std::uint8_t unit_id = 1;
  std::array<Register, kFieldCount> fields{};
  PerAxis<std::array<Register, kAxisFieldCount>> axes{};
  PerAxis<double> axis_scale{};       ///< deg, mm or slots per count; may be negative
  double monitor_scale = 1.0;         ///< monitor units per count
  double temperature_scale_c = 0.01;  ///< deg C per count
  double humidity_scale_percent = 0.01;
  friend bool operator==(const RegisterMap&, const RegisterMap&) = default;

  [[nodiscard]] const Register& at(Field f) const { return fields[static_cast<std::size_t>(f)]; }
  [[nodiscard]] const Register& at(Axis a, AxisField f) const { return axes[index_of(a)][static_cast<std::size_t>(f)]; }

  /// The run from the lowest to the highest register of the status fields (Token .. GateMonitorSamples and every axis'
  /// but its target). At most 125 registers; a map that is wider is refused when it is read.
  [[nodiscard]] Block status_block() const;
  [[nodiscard]] Block motion_block() const;
  [[nodiscard]] Block halt_block() const;
  [[nodiscard]] Block reset_block() const;
  [[nodiscard]] Block shutter_block() const;
};

inline constexpr std::uint16_t kIdentity = 0x474F;
inline constexpr std::uint16_t kMapVersion = 1;
inline constexpr std::uint16_t kHaltKey = 0x5A5A;
inline constexpr std::uint16_t kResetKey = 0x4B4B;
inline constexpr std::uint16_t kCommandMove = 1;
inline constexpr std::uint16_t kCommandHome = 2;
inline constexpr std::uint16_t kCommandMoveTogether = 3;  ///< start and arrive together

/// Bits of `status`.
enum class StatusBit : std::uint8_t { Moving, Homed, Halted, HeartbeatTripped, Fault, InterlockOpen };
/// Bits of an axis' status.
enum class AxisBit : std::uint8_t { Moving, Homed, AtLowLimit, AtHighLimit };
[[nodiscard]] constexpr std::uint16_t bit(StatusBit b) {
  return static_cast<std::uint16_t>(1U << static_cast<unsigned>(b));
}
[[nodiscard]] constexpr std::uint16_t bit(AxisBit b) {
  return static_cast<std::uint16_t>(1U << static_cast<unsigned>(b));
}

enum class ShutterState : std::uint8_t { Closed, Open, Moving };

/// Why the stage refused a motion command.
enum class Refusal : std::uint8_t {
  None,
  EpochTooOld,
  Halted,
  HeartbeatTripped,
  NotHomed,
  BeyondLimit,
  Fault,
  InterlockOpen,
  AlreadyMoving,
  BadCommand
};
[[nodiscard]] std::string_view refusal_name(Refusal refusal);

/// The map of our own controller, as the page beside this header lists it.
[[nodiscard]] RegisterMap own_register_map();

/// "gate_monitor_mean": the name of a field in TOML and in messages.
[[nodiscard]] std::string_view field_name(Field field);
[[nodiscard]] std::string_view field_name(AxisField field);

/// Reads the table [stage.registers] of instrument.toml. Errors stick in `table`: unknown or missing registers, two
/// fields on one register, a status block of more than 125 registers.
[[nodiscard]] RegisterMap read_register_map(TomlReader& table);
/// The same as TOML text, under the heading `[prefix]` ("stage.registers"); read back it is equal.
[[nodiscard]] std::string to_toml(const RegisterMap& map, std::string_view prefix);

/// The value of a register inside a block that was read from `block_first` on; the register must lie inside (asserted).
[[nodiscard]] std::int64_t decode(std::span<const std::uint16_t> block, std::uint16_t block_first, const Register& reg);
/// Writes a value's words into a block; the value must fit (asserted).
void encode(std::span<std::uint16_t> block, std::uint16_t block_first, const Register& reg, std::int64_t value);

}  // namespace gonio::stage
