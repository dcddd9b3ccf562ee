#pragma once

#include <string>

#include "daemon/planner/time_experience.h"
#include "daemon/store/database.h"

namespace gonio::daemon {

/// What the last finished scans of this configuration took beside what was predicted for them, cause by cause; the next
/// one's standard deviation from the scatter between them. Holds and devices that failed say nothing of another scan.
/// Errors stick in the database.
[[nodiscard]] TimeExperience read_experience(Database& database, const std::string& configuration_hash);

}  // namespace gonio::daemon
