#pragma once

#include <optional>
#include <string>

#include "base/result.h"
#include "daemon/store/records.h"
#include "daemon/store/store_reader.h"
#include "protocol/api/calibration_reports.h"

namespace gonio::daemon {

/// What the calibration job of a scan finds in its stored readings; nothing when its plan names no job. `brdf`: of the
/// scan, as just computed. Errors: those of the store, of the texts, and of the fit.
[[nodiscard]] Result<std::optional<NewFoundCalibration>> fit_job(StoreReader& reader, ScanId scan, const NewBrdf& brdf);

/// "calibration-found": the job and its note.
[[nodiscard]] NewEvent event_found(const NewFoundCalibration& found);

/// The runs of a check standard, one for each of its scans (the newest fit of it). Errors: NotFound, those of the
/// store.
[[nodiscard]] Result<api::ChartReport> chart_of(StoreReader& reader, const std::string& standard);

}  // namespace gonio::daemon
