#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "base/large_array.h"
#include "calibration/raw_reading.h"
#include "daemon/store/database.h"
#include "daemon/store/records.h"
#include "drivers/stage_config.h"

namespace gonio::daemon {

/// Rows of one table with from <= id < to.
struct IdRange {
  std::int64_t from = 0;
  std::int64_t to = 0;
};

/// Rows of `reading`, and the attempts among which those of them lie that belong to attempts.
struct ReadingPart {
  IdRange readings;
  IdRange attempts;
};

/// What the rows of a scan are read with.
struct RowContext {
  ScanId scan;
  const drivers::StageConfig& stage;
  const std::vector<calibration::PlannedPoint>& points;
  std::map<std::int64_t, std::int64_t> scale_of_run;  ///< ns, onto the clock of the boot time
};

/// The scan's readings in one part of the rows: of accepted attempts and of visits, frames of one attempt or visit at
/// one exposure, or in one range, together. Each table is read by itself, in the order of its rows, and found again by
/// number. Errors stick in `database`.
[[nodiscard]] LargeArray<calibration::RawReading> read_rows(Database& database, const ReadingPart& part,
                                                            const RowContext& context);

}  // namespace gonio::daemon
