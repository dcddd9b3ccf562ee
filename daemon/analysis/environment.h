#pragma once

#include <string>
#include <vector>

#include "daemon/store/scan_history.h"
#include "protocol/api/analysis.h"

namespace gonio::analysis {

/// What was latched with the readings of a scan, from the least to the largest: lamp, detector, room, humidity,
/// monitor; and how many readings of each kind there are. The report's numbers are these.
[[nodiscard]] std::vector<api::AnalysisFact> environment_facts(const std::vector<daemon::HistoryReading>& readings);

/// All of them as CSV, a reading a line, by the numbers that the store knows them by.
[[nodiscard]] std::string readings_table(const std::vector<daemon::HistoryReading>& readings);

}  // namespace gonio::analysis
