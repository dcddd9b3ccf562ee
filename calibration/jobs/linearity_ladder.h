#pragma once

#include "base/result.h"
#include "calibration/instrument_model.h"
#include "calibration/jobs/found_values.h"
#include "calibration/raw_reading.h"

namespace gonio::calibration {

struct LadderOptions {
  int order = 2;  ///< of the polynomial, 1 to 3
};

/// A camera's linearity and exposure offset from a ladder of exposures, each item a light of its own:
///   light = N (1 + a1 x + a2 x^2 + ..),  x = N / full scale,   light = L_item m (t + t0),
/// fitted in its logarithm by Gauss and Newton's method, weighted by photon transfer (EMVA 1288 release 4.0, eq 5) and
/// the monitor's noise; the dark level's error of each exposure is a parameter with its own prior uncertainty. On a
/// region of pixels that differ, the powers of N are their means, by the region's moments.
/// Values: "linearity_1" .. "linearity_<order>" (1), "exposure_offset_s" (s), with their covariance, larger by
/// chi-square over its degrees of freedom where that exceeds 1.
/// Errors: IncompleteData (a radiometer, frames reduced by maps, fewer exposures than order + 3).
[[nodiscard]] Result<FoundValues> fit_linearity(const ScanReadings& scan, const InstrumentModel& instrument,
                                                const LadderOptions& options);

}  // namespace gonio::calibration
