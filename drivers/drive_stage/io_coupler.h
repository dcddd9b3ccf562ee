#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "drivers/drive_stage/unit_line.h"
#include "drivers/stage.h"
#include "protocol/stage/io_map.h"

namespace gonio::drivers {

/// Shutters, interlock, monitor and sensors behind one coupler. What its map does not have reads as: shutter open,
/// interlock closed, monitor 1, sensors 0. Threads: owned by one.
class IoCoupler {
 public:
  /// All must outlive it. A shutter without an end switch counts as there `travel` after it was told.
  IoCoupler(UnitLine& line, const stage::IoMap& map, const Clock& clock, Duration travel);

  /// Fills in what the coupler knows. Errors: as UnitLine.
  [[nodiscard]] Result<void> look(StageState& state);
  /// Errors: as UnitLine; DeviceRefused (a shutter that is not there was to close).
  [[nodiscard]] Result<void> set_shutters(bool source_open, bool detector_open);

 private:
  struct Shutter {
    const char* name;
    const std::optional<stage::IoBits>& output;
    const std::optional<stage::IoBits>& open;
    const std::optional<stage::IoBits>& closed;
    std::optional<Instant> told;
  };
  [[nodiscard]] Result<void> set(Shutter& shutter, bool open);
  [[nodiscard]] Result<void> read_all();
  [[nodiscard]] bool is(const std::optional<stage::IoBits>& bits) const;
  [[nodiscard]] double value(const std::optional<stage::IoNumber>& number, double otherwise) const;
  [[nodiscard]] std::int64_t raw(const stage::Register& reg) const;
  [[nodiscard]] stage::ShutterState state_of(const Shutter& shutter) const;

  UnitLine& line_;
  const stage::IoMap& map_;
  const Clock& clock_;
  Duration travel_;
  Shutter source_;
  Shutter detector_;
  std::vector<stage::Block> runs_;  ///< what is read at each look
  std::map<std::uint16_t, std::uint16_t> words_;
};

}  // namespace gonio::drivers
