#pragma once

#include "sim/scene/scene.h"

namespace gonio::bench {

/// An instrument for timing its wires: one lit surface, a square frame of so many pixels a side.
[[nodiscard]] sim::Scene bench_scene(int side_px = 64);

}  // namespace gonio::bench
