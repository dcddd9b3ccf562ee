#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "daemon/sequencer/command.h"
#include "daemon/sequencer/measurement.h"
#include "daemon/store/records.h"

namespace gonio::daemon {

/// The events that the sequencer writes: kind and JSON. README.md lists them for clients; nlohmann-json stays in the
/// .cpp.
[[nodiscard]] NewEvent event_submitted(const NewScan& scan);
[[nodiscard]] NewEvent event_transition(const ScanTransition& transition);
/// With the scan's figures: what its summary shows of the run.
[[nodiscard]] NewEvent event_over(const ScanTransition& transition, const Progress& progress);
[[nodiscard]] NewEvent event_hold_added(ScanId scan, const Hold& hold);
[[nodiscard]] NewEvent event_holds_cleared(ScanId scan, const std::vector<Hold>& holds, const std::string& who);
/// "item-accepted", "item-failed", "item-dropped" by the attempt's outcome.
[[nodiscard]] NewEvent event_attempt(const NewAttempt& attempt, const Measurement& measurement);
[[nodiscard]] NewEvent event_skipped(const SkipItem& skip);
[[nodiscard]] NewEvent event_visit(const NewVisit& visit);
/// `kept`: points between the visits that were measured again often enough.
[[nodiscard]] NewEvent event_reopened(const NewVisit& visit, double drift_limit, std::int64_t kept);
/// What was changed, with what it was before.
[[nodiscard]] NewEvent event_changed(const ChangeScan& change, const ScanPolicy& policy, const ScanTurn& turn,
                                     const std::string& who);
[[nodiscard]] NewEvent event_calibration_used(const UseCalibration& use, const std::string& who);
[[nodiscard]] NewEvent event_recompute_asked(const RecomputeScan& recompute, const std::string& who);
[[nodiscard]] NewEvent event_stop(ScanId scan, const std::string& who, drivers::Epoch epoch);

}  // namespace gonio::daemon
