#pragma once

#include <optional>
#include <string>

#include "base/result.h"
#include "calibration/raw_reading.h"
#include "daemon/store/database.h"
#include "daemon/store/records.h"
#include "drivers/stage_config.h"

namespace gonio::daemon {

/// All that a scan's BRDF is made from (StoreReader::readings); nothing where there is no such scan. `database` is
/// within a transaction, which says what there is: rows of points, attempts and readings never change, so that
/// several connections to the same file, `path`, each read a part of them, one a thread of the machine. Errors of
/// `database` stick in it, those of the others come back.
[[nodiscard]] Result<std::optional<calibration::ScanReadings>> read_scan_readings(Database& database,
                                                                                  const std::string& path, ScanId scan,
                                                                                  const drivers::StageConfig& stage);

}  // namespace gonio::daemon
