#pragma once

#include <string>

#include "base/clock.h"
#include "base/geometry.h"
#include "base/result.h"
#include "base/units.h"
#include "calibration/instrument_model.h"
#include "calibration/raw_reading.h"
#include "calibration/reference_standard.h"

namespace gonio::calibration {

/// How a point would be measured.
struct Expectation {
  ReferenceMode mode = ReferenceMode::SameGeometry;
  Geometry anchor;            ///< in anchor mode
  double snr = 300.0;         ///< of a reading
  double visit_snr = 1000.0;  ///< of a visit of the standard
  Duration apart{};           ///< between a sample reading and what it is compared with
};

/// What its budget would be, for a sample as white as the standard and without a slope.
struct ExpectedBudget {
  double relative_u = 0.0;  ///< U / f
  std::string dominant;     ///< the component with the largest share of u
  bool is_mixed = false;
};

/// The budget of point_budget.h for a point that nobody has measured: what depends on the sample (slopes along the
/// angles, signals too weak for `snr`) and on the scan's own darks is not in it. Errors: ReferenceOutOfReach (the
/// standard, at the point or the anchor), those of absolute_ratio.
[[nodiscard]] Result<ExpectedBudget> expected_budget(const Geometry& g, Wavelength wavelength,
                                                     const Expectation& expectation, const InstrumentModel& instrument,
                                                     const ReferenceStandard& standard);

}  // namespace gonio::calibration
