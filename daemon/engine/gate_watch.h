#pragma once

#include <cstdint>
#include <optional>

#include "base/clock.h"
#include "base/result.h"
#include "daemon/sequencer/messages.h"
#include "drivers/motion/motion_progress.h"
#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::daemon {

/// Waits for one exposure as the stage's gate sees it: a pure state machine that is shown `StageState`s. Done when the
/// gate has counted one more and has closed, and every held position lay in its axis' window when it opened and when it
/// closed.
class GateWatch {
 public:
  /// `boot_counter` is the stage's as last seen; nothing when it has not been seen yet.
  GateWatch(const drivers::StageConfig& config, const WatchGate& request, std::optional<std::uint32_t> boot_counter,
            Instant now);

  /// Errors: PositionLost (the boot counter changed), DeviceFault, StaleData (more than one exposure was counted),
  /// OutOfTolerance (axis, where it was, its window), TimedOut.
  [[nodiscard]] Result<drivers::MotionProgress> look(const drivers::StageState& seen, Instant now);

  [[nodiscard]] Instant first_look() const { return started_ + request_.expected; }
  [[nodiscard]] Instant deadline() const { return deadline_; }

 private:
  [[nodiscard]] Result<void> check_stage(const drivers::StageState& seen) const;
  [[nodiscard]] Result<void> check_held(const drivers::GateRecord& gate) const;
  [[nodiscard]] Error error(ErrorCode code, std::string seen, std::string limit = {}) const;

  const drivers::StageConfig& config_;
  WatchGate request_;
  std::optional<std::uint32_t> boot_counter_;
  Instant started_;
  Instant deadline_;
  Duration poll_;
};

}  // namespace gonio::daemon
