#pragma once

#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::drivers::test {

/// A stage of round numbers: every axis 0 to 90, 10 per s, 20 per s^2, settles 0.1 s within +- 0.01; deadlines are 1.5
/// times the computed time plus 1 s.
[[nodiscard]] StageConfig simple_config();
/// All axes homed and at rest at zero, nothing wrong, boot counter 7, stop count 3, epoch 5, tokens 100 and 101.
[[nodiscard]] StageState resting_state();

}  // namespace gonio::drivers::test
