#pragma once

#include "base/result.h"
#include "daemon/store/database.h"

namespace gonio::daemon {

/// What this program writes: PRAGMA user_version.
inline constexpr int kSchemaVersion = 13;

/// Brings the file to kSchemaVersion, forward only, each step in its own transaction. Errors: StoreTooNew, StoreFailed,
/// DiskFull.
[[nodiscard]] Result<void> migrate(Database& database);
/// Errors: StoreTooNew; StoreFailed when the file is older than this program or not a store at all.
[[nodiscard]] Result<void> check_version(Database& database);

}  // namespace gonio::daemon
