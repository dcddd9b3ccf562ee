#pragma once

#include <optional>
#include <vector>

#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::drivers {

/// A way from `from` to `to` in legs, each clear by `path_conflict`, the soonest of a short list: some of the axes
/// before the others, one arm laid to a limit while the rest moves, the detector swung aside while the rest moves.
/// Every leg names every axis that `to` names, and those that it moves aside; the last is where all of them end. Call
/// it when the direct way is blocked. Nothing: none of the list is clear.
[[nodiscard]] std::optional<std::vector<MotionTarget>> detour(const StageConfig& config,
                                                              const stage::PerAxis<double>& from,
                                                              const MotionTarget& to);

}  // namespace gonio::drivers
