#pragma once

#include <string>

#include "base/result.h"
#include "calibration/jobs/found_values.h"
#include "daemon/config/instrument.h"
#include "daemon/store/store_reader.h"
#include "protocol/api/plan_calibration.h"

namespace gonio::daemon {

/// Whether a job of this name makes maps.
[[nodiscard]] bool makes_maps(const std::string& job);

/// What a dark map or a flat field says of the pixels, from the sums in the store; its note has the SHA-256 of each
/// file. Errors: those of the store and of the fit.
[[nodiscard]] Result<calibration::FoundValues> map_values_of(StoreReader& reader, ScanId scan,
                                                             const Instrument& instrument, api::CalibrationJob job);

/// The bytes of one of its files, made anew from the store: "dark", "bad_pixels" or "flat", as `[detector.maps]` has
/// them. Errors: those above; NotFound (no such version, its job makes no maps, or not this one), ReplayDiffers (other
/// values come out than the version holds).
[[nodiscard]] Result<std::string> map_file_of(StoreReader& reader, CalibrationVersion version, const std::string& name);

}  // namespace gonio::daemon
