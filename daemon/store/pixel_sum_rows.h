#pragma once

#include "base/result.h"
#include "daemon/store/database.h"
#include "daemon/store/store_reader.h"

namespace gonio::daemon {

/// The rows of `pixel_sum` of a scan, by exposure. One row is in memory at a time, beside the stacks. Errors of SQL
/// stick in the database; IncompleteData: those of PixelStack.
[[nodiscard]] Result<PixelStacks> read_pixel_stacks(Database& database, ScanId scan);

}  // namespace gonio::daemon
