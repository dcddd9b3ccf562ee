#pragma once

#include "cli/output.h"
#include "protocol/api/analysis.h"
#include "protocol/api/instrument_report.h"
#include "protocol/api/reports.h"

namespace gonio::cli {

/// What people see of each report, as rows.
[[nodiscard]] Table view(const api::StatusReport& status);
[[nodiscard]] Table view(const api::StageReport& stage);
[[nodiscard]] Table view(const api::PlanReport& plan);
[[nodiscard]] Table view(const api::ScanReport& scan);
[[nodiscard]] Table view(const api::ScanList& scans);
[[nodiscard]] Table view(const api::ReferenceList& references);
[[nodiscard]] Table view(const api::ReferenceReport& reference);
[[nodiscard]] Table view(const api::CommandReport& command);
[[nodiscard]] Table view(const api::StopReport& stop);
[[nodiscard]] Table view(const api::Event& event);

[[nodiscard]] Table view(const api::InstrumentReport& instrument);
[[nodiscard]] Table view(const api::DetectorReading& reading);
[[nodiscard]] Table view(const api::AnalysisReport& job);
[[nodiscard]] Table view(const api::AnalysisList& jobs);

/// "operator (local: lunch), lamp (detector: ...)"; empty without holds.
[[nodiscard]] std::string holds_text(const api::ScanReport& scan);
/// One line on how far a scan is: "scan 3 wheat: 621 of 1242 items, 50.0 %, running, 12 min 5 s to go (+- 20.0 s)".
[[nodiscard]] std::string progress_text(const api::ScanReport& scan);

}  // namespace gonio::cli
