#pragma once

#include <string>

#include "base/result.h"
#include "calibration/jobs/found_values.h"
#include "calibration/raw_reading.h"
#include "daemon/store/records.h"

namespace gonio::daemon {

/// What a working standard has from its master: REFF at 0/45, the mean of all points there, for each wavelength of the
/// scan, as "reff_0_45_<nm>nm" (1) with the covariance that the master's certificate and all else shared brings.
/// `master`: its serial number, for the note. Errors: IncompleteData (a wavelength without a value at 0/45).
[[nodiscard]] Result<calibration::FoundValues> transfer_of(const NewBrdf& brdf,
                                                           const calibration::ScanReadings& readings,
                                                           const std::string& master);

}  // namespace gonio::daemon
