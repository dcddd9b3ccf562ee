#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "drivers/drive_stage/drive_latch.h"
#include "drivers/drive_stage/drive_links.h"
#include "drivers/drive_stage/drive_unit.h"
#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::drivers {

/// STOP and heartbeat of a stage of drives. A halt closes the latch first, then says quick stop to one drive after the
/// other; one that does not answer is passed over and said to again when all others have stopped, `kHaltTries` times in
/// all. The heartbeat is each drive's own communication watchdog: a beat reads it, which feeds it, and writes it where
/// it is not what it should be, as after a loss of power.
class DriveHaltLine final : public HaltLine {
 public:
  static constexpr int kHaltTries = 3;

  /// `halts` interrupt what is in progress, `beats` wait their turn; of one thread. All must outlive it.
  DriveHaltLine(const DriveLinks& halts, const DriveLinks& beats, const StageConfig& config, DriveLatch& latch,
                const Clock& clock);
  ~DriveHaltLine() override;

  /// Errors: also DeviceRefused.
  Result<void> halt(Epoch epoch) override;
  /// Notes the timeout; `beat` writes it.
  Result<void> watch_heartbeat(Duration timeout) override;
  Result<void> beat() override;
  void interrupt() override;

 private:
  struct Drive;
  [[nodiscard]] Result<void> feed(Drive& drive);
  [[nodiscard]] bool take(ModbusLink* link);

  DriveLatch& latch_;
  std::vector<std::unique_ptr<Drive>> drives_;
  Duration timeout_{};
  std::uint16_t beats_ = 0;
  std::mutex mutex_;              ///< guards the two below
  ModbusLink* in_use_ = nullptr;  ///< by the beat in progress
  bool is_interrupted_ = false;
};

}  // namespace gonio::drivers
