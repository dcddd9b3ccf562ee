#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "daemon/store/records.h"

namespace gonio::daemon {

/// How the versions that a BRDF was computed with are stored and said: numbers, separated by single spaces.
[[nodiscard]] std::string version_list_text(const std::vector<CalibrationVersion>& versions);
/// Back again; what is not a number ends the list.
[[nodiscard]] std::vector<CalibrationVersion> version_list_from(std::string_view text);

}  // namespace gonio::daemon
