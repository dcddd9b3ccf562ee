#pragma once

#include "base/result.h"
#include "daemon/config/instrument.h"
#include "drivers/stage.h"

namespace gonio::daemon {

/// One look at a stage around an exposure that drives no gate: is it there, at rest, and every held position within its
/// axis' window? Errors: DeviceFault, OutOfTolerance (axis, where it was, its window; or a motion), PositionLost (home
/// is gone). `when`: "before" or "after" the exposure.
[[nodiscard]] Result<void> check_held(const Instrument& instrument, const drivers::MotionTarget& held,
                                      const drivers::StageState& seen, const char* when);

/// What a gate would have latched, from a look before and one after the exposure: counts of the encoders at both, no
/// gate count; the stage's monitor from both. Both have passed check_held, and the exposure lies between them. Errors:
/// PositionLost (the boot counter changed between them).
[[nodiscard]] Result<drivers::GateRecord> window_record(const drivers::StageState& before,
                                                        const drivers::StageState& after);

}  // namespace gonio::daemon
