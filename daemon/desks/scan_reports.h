#pragma once

#include <optional>

#include "base/clock.h"
#include "daemon/sequencer/command.h"
#include "daemon/store/store_reader.h"
#include "drivers/stage.h"
#include "protocol/api/reports.h"

namespace gonio::daemon {

/// What the store and the sequencer know, in the words of the API.
[[nodiscard]] api::ScanReport scan_report(const ScanInfo& info, Instant now);
/// Puts what only the sequencer knows of the active scan on top.
void add_progress(api::ScanReport& report, const SequencerStatus& status, Instant now);
[[nodiscard]] api::StageReport stage_report(const drivers::StageState& state, Instant now);
[[nodiscard]] api::PointReport point_report(const PointInfo& info);
[[nodiscard]] api::Event event_report(const EventRecord& event);
[[nodiscard]] api::WarmUpReport warm_up_report(const WarmUpProgress& progress);
[[nodiscard]] api::TimeSplit time_split(const TimeParts& parts);

}  // namespace gonio::daemon
