#pragma once

#include <string>

#include "base/result.h"
#include "protocol/api/requests.h"

namespace gonio::cli {

/// A plan as it is sent: its text, and the text of each file that it names (`points` of [geometry] and its parts),
/// looked for beside it. A text that is not TOML is sent alone: the daemon says what is wrong with it. Errors:
/// FileUnreadable.
[[nodiscard]] Result<api::PlanSubmission> read_plan(const std::string& path);

}  // namespace gonio::cli
