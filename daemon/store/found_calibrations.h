#pragma once

#include <vector>

#include "daemon/store/database.h"
#include "daemon/store/store_reader.h"

namespace gonio::daemon {

/// All that calibration jobs have found, oldest first. Errors stick in the database.
[[nodiscard]] std::vector<FoundCalibration> read_found_calibrations(Database& database);

}  // namespace gonio::daemon
