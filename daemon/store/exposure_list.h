#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/clock.h"

namespace gonio::daemon {

/// How a plan's exposures are stored: nanoseconds, separated by single spaces; empty when they are chosen.
[[nodiscard]] std::string exposure_list_text(const std::vector<Duration>& exposures);
/// Back again; what is not a number ends the list.
[[nodiscard]] std::vector<Duration> exposure_list_from(std::string_view text);

}  // namespace gonio::daemon
