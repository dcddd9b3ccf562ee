#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calibration/instrument_model.h"
#include "calibration/raw_reading.h"
#include "daemon/config/instrument.h"
#include "daemon/store/store_reader.h"
#include "protocol/api/calibration_reports.h"

namespace gonio::daemon {

/// The versions that a BRDF is computed with; none: those that count when it is computed.
using AskedVersions = std::optional<std::vector<CalibrationVersion>>;

/// As a person writes them: empty for those that count, "none", or numbers separated by blanks or commas.
/// Errors: InvalidInput.
[[nodiscard]] Result<AskedVersions> asked_versions_from(const std::string& text);
/// Of the event "recompute-asked".
[[nodiscard]] AskedVersions asked_versions_of(const EventRecord& event);

/// An instrument's model with what was found of it.
struct ModelOfVersions {
  calibration::InstrumentModel model;
  std::vector<CalibrationVersion> versions;  ///< ascending
};
/// Those that count but were found on another detector are left out; one that is asked for is refused.
/// Errors: NotFound (no such version), InvalidInput (two of one job; one whose job changes no scan; another detector),
/// IncompleteData (a step that needs the frames themselves, which were not kept; it names version and step).
[[nodiscard]] Result<ModelOfVersions> model_with(const std::vector<FoundCalibration>& all, const AskedVersions& asked,
                                                 const Instrument& instrument,
                                                 const calibration::ScanReadings& readings);

/// The instrument with all that counts of what was found of it. Errors: those of the store and of model_with.
[[nodiscard]] Result<Instrument> as_known(Instrument instrument, StoreReader& reader);

/// Whether what this job finds can change a scan; a check standard's run, a transfer and a signature cannot, nor maps
/// of pixels: frames are reduced with them as they come, and are gone.
[[nodiscard]] bool changes_scans(const std::string& job);

/// Errors: NotFound.
[[nodiscard]] Result<FoundCalibration> found_version(StoreReader& reader, CalibrationVersion version);

[[nodiscard]] api::CalibrationReport calibration_report(const FoundCalibration& found);

}  // namespace gonio::daemon
