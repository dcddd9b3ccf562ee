#pragma once

#include "base/result.h"
#include "sim/faults/fault_plan.h"
#include "sim/scene/scene.h"

namespace gonio::sim {

/// Whether the scene has the device that a fault is meant for: its radiometer, or drives. Errors: InvalidInput.
[[nodiscard]] Result<void> check_fault(const PlannedFault& fault, const Scene& scene);

}  // namespace gonio::sim
