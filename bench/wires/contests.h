#pragma once

namespace gonio::bench {

/// Each sets up a simulated device, runs its contests for so many rounds, prints a line each; true when all hold.
[[nodiscard]] bool hold_stage_over_tcp(int rounds);
[[nodiscard]] bool hold_stage_over_rtu(int rounds);
[[nodiscard]] bool hold_camera(int rounds);

}  // namespace gonio::bench
