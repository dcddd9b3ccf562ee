#pragma once

#include <string>

#include "base/clock.h"
#include "base/result.h"
#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::drivers {

/// What stands for one motion command while it is under way, and what every look at the stage must still agree with.
/// A pure value: shown `StageState`s, it says whether the stage still obeys this command and nobody else's.
class MotionWatch {
 public:
  /// `before` is a look from just before the command was sent; `tried` names the motion in errors.
  MotionWatch(const StageState& before, MotionToken token, Epoch epoch, std::string tried);

  /// True when the command was accepted and nothing is wrong; false when the stage has not taken it up yet.
  /// Errors, the cause before its consequences: PositionLost (the boot counter changed), what the stage refused it for
  /// (StaleEpoch, Stopped, HeartbeatTripped, NotHomed, DeviceFault, Interlock; DeviceRefused with the refusal's name
  /// for the rest), DeviceFault, Interlock, HeartbeatTripped, Stopped (somebody halted the stage), ControlLost (the
  /// stage obeys a command that is not ours).
  [[nodiscard]] Result<bool> look(const StageState& seen);

  [[nodiscard]] Error error(ErrorCode code, std::string seen, std::string limit = {}) const;

 private:
  [[nodiscard]] Result<void> check_power(const StageState& seen) const;
  [[nodiscard]] Result<void> check_refusal(const StageState& seen) const;
  [[nodiscard]] Result<void> check_stops(const StageState& seen) const;

  std::uint32_t boot_counter_;
  std::uint16_t stop_count_;
  MotionToken accepted_before_;
  MotionToken token_;
  Epoch epoch_;
  std::string tried_;
  bool accepted_ = false;
};

/// The first fault that the stage reports, in words: "fault 2 (drive fault), axis theta_r fault 1 (following error)";
/// empty when there is none.
[[nodiscard]] std::string fault_text(const StageState& seen);

}  // namespace gonio::drivers
