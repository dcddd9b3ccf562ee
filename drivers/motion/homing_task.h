#pragma once

#include "base/clock.h"
#include "base/result.h"
#include "drivers/motion/motion_progress.h"
#include "drivers/motion/motion_watch.h"
#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::drivers {

/// Waits for homing: a pure state machine that is shown `StageState`s. Done when our command was accepted, nobody
/// stopped the stage, and it says that all axes are homed and at rest.
class HomingTask {
 public:
  HomingTask(const StageConfig& config, const StageState& before, MotionToken token, Epoch epoch, Instant now);

  /// Errors: those of MotionWatch; MotionLate with the first axis that is not homed.
  [[nodiscard]] Result<MotionProgress> look(const StageState& seen, Instant now);

  [[nodiscard]] Instant first_look() const { return started_; }
  [[nodiscard]] Instant deadline() const { return deadline_; }

 private:
  MotionWatch watch_;
  Instant started_;
  Instant deadline_;
};

}  // namespace gonio::drivers
