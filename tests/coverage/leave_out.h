#pragma once

#include <cstdint>
#include <vector>

#include "calibration/instrument_model.h"
#include "calibration/raw_reading.h"
#include "calibration/reference_definition.h"
#include "tests/coverage/coverage_scene.h"

namespace gonio::coverage {

/// Corrections that a test can take away, by what `calibrate` is given. The uncertainty of the correction stays.
enum class Correction : std::uint8_t {
  Dark,            ///< the dark current: all darks are those of the shortest exposure
  Ambient,         ///< no visit with the source's shutter closed
  Stray,           ///< no visit of the trap
  Linearity,       ///< the curve is told as straight
  ExposureOffset,  ///< t0 is told as 0
  Monitor,         ///< it shows its first value all the time
  Visits,          ///< there were none
  Shape,           ///< the reference is told as Lambertian
  Cones,           ///< their bias, by the option of `calibrate`
  Overlap,         ///< the factor of the geometry, by the option of `calibrate`
  Correlation,     ///< shared terms are summed as if they were random
};
[[nodiscard]] const char* correction_name(Correction correction);

/// Each correction with a scene that needs it.
struct LeftOutCase {
  Correction correction;
  const char* scene;
};
[[nodiscard]] std::vector<LeftOutCase> left_out_cases();

void leave_out(Correction correction, PreparedScene& scene);
void leave_out(Correction correction, calibration::ScanReadings& readings);

}  // namespace gonio::coverage
