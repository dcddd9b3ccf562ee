#pragma once

#include <cstdint>
#include <span>

#include "base/result.h"
#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::drivers {

/// The whole status block as a StageState, but for its time.
/// Errors: WrongDevice (identity or map version), BadReply (a word that no stage may send).
[[nodiscard]] Result<StageState> stage_state_of(std::span<const std::uint16_t> block, const StageConfig& config);

}  // namespace gonio::drivers
