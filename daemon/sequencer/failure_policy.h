#pragma once

#include <cstdint>
#include <optional>

#include "base/error.h"
#include "daemon/store/records.h"

namespace gonio::daemon {

/// What a failure in mid-scan asks for.
enum class Reaction : std::uint8_t {
  TryAgain,          ///< bounded by the plan; then the plan's on_error
  TryAgainThenHold,  ///< bounded by the plan; then hold `device`: the next item would fail likewise
  GiveUpItem,        ///< trying again cannot help: the plan's on_error at once
  Hold,              ///< at once
};
[[nodiscard]] Reaction reaction_to(const Error& error);
/// Which hold a failure stands for: `operator` after a STOP, `door` for the interlock, else `device`.
[[nodiscard]] HoldName hold_for(ErrorCode code);

}  // namespace gonio::daemon
