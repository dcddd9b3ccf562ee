#pragma once

#include <string>

#include "base/result.h"
#include "protocol/api/calibration_reports.h"

namespace gonio::cli {

/// The certificate that a transfer gives its working standard, as CSV for `reference import` (calibration/README.md):
/// REFF at 0/45 by wavelength with U (k = 2), and the mean correlation of the wavelengths' errors. Serial number: the
/// scan's sample. Between wavelengths further apart than `longest_gap_nm` nothing is claimed. Comments say where it
/// comes from. Errors: InvalidInput (a version of another job; nothing found).
[[nodiscard]] Result<std::string> certificate_csv(const api::CalibrationReport& transfer, const std::string& expires,
                                                  double longest_gap_nm);

}  // namespace gonio::cli
