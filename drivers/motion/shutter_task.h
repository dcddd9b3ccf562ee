#pragma once

#include "base/clock.h"
#include "base/result.h"
#include "drivers/motion/motion_progress.h"
#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::drivers {

/// Waits for both shutters: a pure state machine that is shown `StageState`s. A STOP does not end it: STOP halts the
/// axes, and a shutter that was told to close is wanted closed all the more.
class ShutterTask {
 public:
  ShutterTask(const StageConfig& config, const StageState& before, bool source_open, bool detector_open, Instant now);

  /// Errors: PositionLost (the boot counter changed, the command is lost with it), MotionLate with the shutter's state.
  [[nodiscard]] Result<MotionProgress> look(const StageState& seen, Instant now);

  [[nodiscard]] Instant first_look() const { return started_; }
  [[nodiscard]] Instant deadline() const { return deadline_; }

 private:
  std::uint32_t boot_counter_;
  stage::ShutterState source_;
  stage::ShutterState detector_;
  Instant started_;
  Instant deadline_;
};

}  // namespace gonio::drivers
