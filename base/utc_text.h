#pragma once

#include <optional>
#include <string_view>

#include "base/clock.h"

namespace gonio {

/// What iso8601 wrote: "2026-11-22T18:05Z", with seconds and parts of them if wanted; always in UTC, which the Z says.
/// Nothing when it is no such text, or no such day.
[[nodiscard]] std::optional<UtcTime> utc_from_iso8601(std::string_view text);

}  // namespace gonio
