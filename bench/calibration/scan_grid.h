#pragma once

#include "calibration/instrument_model.h"
#include "calibration/raw_reading.h"
#include "calibration/reference_standard.h"

namespace gonio::bench {

/// A grid of directions at one wavelength, each with its own sample and reference reading, a dark visit each thousand
/// points and a visit of the standard each two thousand; without noise: what is timed does not depend on it.
[[nodiscard]] calibration::ScanReadings scan_grid(int points);

/// The standard and the instrument that it is reduced with.
[[nodiscard]] calibration::ReferenceStandard grid_standard();
[[nodiscard]] calibration::InstrumentModel grid_instrument();

}  // namespace gonio::bench
