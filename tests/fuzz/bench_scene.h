#pragma once

#include "sim/scene/scene.h"

namespace gonio::fuzz {

/// A small bench without noise, for the targets that talk to simulated devices.
[[nodiscard]] sim::Scene bench_scene();

}  // namespace gonio::fuzz
