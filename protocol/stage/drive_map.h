#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/toml_reader.h"
#include "protocol/stage/register_map.h"

namespace gonio::stage {

/// How registers are read: FC3 or FC4 (Modbus Application Protocol V1.1b3, 6.3 and 6.4).
enum class ReadFunction : std::uint8_t { Holding, Input };
/// How one register is written: FC6 or FC16 (6.6 and 6.12). Several are always written by FC16.
enum class WriteFunction : std::uint8_t { Single, Multiple };

/// What a step writes when it is no fixed number: what the driver knows of this axis, in the drive's counts.
enum class DriveValue : std::uint8_t { Fixed, Target, Speed, Acceleration, LowLimit, HighLimit };

/// One step of a command: a write, or a wait until a register shows something.
struct DriveStep {
  enum class Kind : std::uint8_t { Write, Await };
  Kind kind = Kind::Write;
  std::string reg;  ///< a name of `DriveMap::registers`
  DriveValue source = DriveValue::Fixed;
  std::int64_t value = 0;   ///< when `source` is Fixed
  std::int64_t mask = 0;    ///< only these bits are written, or compared; 0: the whole register
  bool unless_set = false;  ///< of a write: left out when this program has written the same there before
  bool or_go_on = false;    ///< of a wait: not seen is no failure
  friend bool operator==(const DriveStep&, const DriveStep&) = default;
};
using DriveCommand = std::vector<DriveStep>;

/// True when (register AND mask) = value.
struct DriveCondition {
  std::string reg;
  std::int64_t mask = 0;
  std::int64_t value = 0;
  friend bool operator==(const DriveCondition&, const DriveCondition&) = default;
};

/// What a drive is told to do, each as steps. The page beside this header says when each is sent.
enum class DriveVerb : std::uint8_t {
  Setup,        ///< once, when the drive is met first or has lost its power: limits, speeds, modes
  Enable,       ///< before a motion, when the drive is not enabled
  PrepareMove,  ///< everything of a move but the last word
  StartMove,    ///< the last word: sent to all axes of a move one after the other
  Home,
  Halt,       ///< quick stop: by the halt line
  ClearStop,  ///< after a halt, on reset: obeys again, without moving
  FaultReset,
};
inline constexpr std::size_t kDriveVerbCount = static_cast<std::size_t>(DriveVerb::FaultReset) + 1;

/// What a drive shows of itself. Moving, Homed, Fault and Enabled every map must know.
enum class DriveFlag : std::uint8_t { Moving, Homed, Fault, Enabled, Stopped, Tripped, FollowingError, AtLimit };
inline constexpr std::size_t kDriveFlagCount = static_cast<std::size_t>(DriveFlag::AtLimit) + 1;

/// One kind of drive as data: a servo or stepper amplifier for one axis, behind one Modbus unit.
struct DriveMap {
  ReadFunction reads = ReadFunction::Holding;
  WriteFunction writes = WriteFunction::Multiple;
  int looks = 100;  ///< so often at most an awaited register is read
  /// By name; `position` must be there. Names with a meaning of their own: `alarm` (shown in errors), `watchdog` (the
  /// drive's own: it stops when it has heard nothing for so long), `feed` (written to feed it, where reading does not).
  std::map<std::string, Register, std::less<>> registers;
  std::array<DriveCommand, kDriveVerbCount> commands;
  std::array<std::optional<DriveCondition>, kDriveFlagCount> flags;
  std::string boot_check;  ///< a register that Setup writes and that does not survive a loss of power; may be empty
  double watchdog_s_per_count = 0.001;
  friend bool operator==(const DriveMap&, const DriveMap&) = default;

  [[nodiscard]] const Register* find(std::string_view name) const;
  [[nodiscard]] const DriveCommand& command(DriveVerb verb) const { return commands[static_cast<std::size_t>(verb)]; }
  [[nodiscard]] const std::optional<DriveCondition>& flag(DriveFlag f) const {
    return flags[static_cast<std::size_t>(f)];
  }
};

[[nodiscard]] std::string_view verb_name(DriveVerb verb);
[[nodiscard]] std::string_view flag_name(DriveFlag flag);
[[nodiscard]] std::string_view value_name(DriveValue value);

/// Reads one table of [stage.drives.maps]. Errors stick in `table`: a register that is not there, a command without
/// steps, a condition that can never hold.
[[nodiscard]] DriveMap read_drive_map(TomlReader& table);
/// The same as TOML text, under the heading `[prefix]`; read back it is equal.
[[nodiscard]] std::string to_toml(const DriveMap& map, std::string_view prefix);

/// CiA 402 (IEC 61800-7-201) in profile position and homing mode, at the Modbus addresses of the Schneider Lexium 32:
/// packaging/drives/lexium32.toml is this as text, with what each register is.
[[nodiscard]] DriveMap lexium32_drive_map();

}  // namespace gonio::stage
