#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "base/result.h"
#include "drivers/drive_stage/unit_line.h"
#include "protocol/stage/drive_map.h"

namespace gonio::drivers {

/// What a command may write besides fixed numbers, in the drive's counts.
struct DriveNumbers {
  std::int64_t target = 0;
  std::int64_t speed = 0;
  std::int64_t acceleration = 0;
  std::int64_t low_limit = 0;
  std::int64_t high_limit = 0;
};

/// One look at a drive.
struct DriveLook {
  std::int64_t counts = 0;
  bool moving = false;
  bool homed = false;
  bool enabled = false;
  bool stopped = false;
  bool fault = false;
  bool tripped = false;  ///< the three below, and the alarm, are asked for only while there is a fault
  bool following_error = false;
  bool at_limit = false;
  std::uint16_t alarm = 0;
};

/// One drive by its map: says commands step by step, and reads what it shows of itself. Threads: owned by one.
class DriveUnit {
 public:
  /// All must outlive it.
  DriveUnit(UnitLine& line, const stage::DriveMap& map) : line_(line), map_(map) {}

  /// Errors: as UnitLine; DeviceRefused when an awaited state was not seen.
  [[nodiscard]] Result<void> run(stage::DriveVerb verb, const DriveNumbers& numbers);
  /// Setup, and each register that it wrote whole read back. Errors: as run; DeviceRefused when one reads otherwise.
  [[nodiscard]] Result<void> set_up(const DriveNumbers& numbers);
  /// The status first and the position after it: at rest by the status, the position is that of the rest.
  [[nodiscard]] Result<DriveLook> look();
  [[nodiscard]] Result<std::int64_t> read_position();
  /// Whether the drive still holds what Setup left in its boot_check register; true where it has none.
  [[nodiscard]] Result<bool> remembers(const DriveNumbers& numbers);

  /// After a loss of power nothing is taken to be set.
  void forget() { written_.clear(); }
  [[nodiscard]] const stage::DriveMap& map() const { return map_; }
  [[nodiscard]] UnitLine& line() { return line_; }

 private:
  using Values = std::map<std::string, std::int64_t, std::less<>>;
  [[nodiscard]] Result<std::int64_t> value_of(const std::string& name, Values& known);
  [[nodiscard]] Result<bool> is(stage::DriveFlag flag, Values& known);
  [[nodiscard]] Result<void> write(const stage::DriveStep& step, const DriveNumbers& numbers);
  [[nodiscard]] Result<void> await(const stage::DriveStep& step);
  [[nodiscard]] Result<void> look_at_fault(DriveLook& look, Values& known);
  [[nodiscard]] const stage::Register& reg(const std::string& name) const;

  UnitLine& line_;
  const stage::DriveMap& map_;
  Values written_;  ///< whole registers as this object last wrote them
};

}  // namespace gonio::drivers
