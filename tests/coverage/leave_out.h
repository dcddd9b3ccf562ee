#pragma once

#include <cstdint>
#include <optional>

#include "calibration/instrument_model.h"
#include "calibration/raw_reading.h"
#include "calibration/reference_definition.h"
#include "tests/coverage/coverage_scene.h"

namespace gonio::coverage {

/// Corrections that a test can take away, by what `calibrate` is given: never by a switch in the code under test. The
/// uncertainty of the correction stays.
enum class Correction : std::uint8_t {
  Dark,            ///< the dark current: all darks are those of the shortest exposure
  Linearity,       ///< the curve is told as straight
  ExposureOffset,  ///< t0 is told as 0
  Monitor,         ///< it shows its first value all the time
  Visits,          ///< there were none
  Shape,           ///< the reference is told as Lambertian
  Correlation,     ///< shared terms are summed as if they were random
};
[[nodiscard]] const char* correction_name(Correction correction);

void leave_out(Correction correction, PreparedScene& scene);
void leave_out(Correction correction, calibration::ScanReadings& readings);

}  // namespace gonio::coverage
