#pragma once

#include "base/units.h"
#include "calibration/calibrated_scan.h"

namespace gonio::calibration {

/// Two values and what does not cancel between them.
struct ScanDifference {
  Brdf value;         ///< a - b
  Brdf u;             ///< of the difference: k = 1
  Brdf u_if_unknown;  ///< as if nothing were in common: the root of both squares
};

/// The difference of a point of `a` and a point of `b`. Components of both scans with the same name and the same,
/// non-empty owner are one error and enter by the difference of their sensitivities; all others add as squares (JCGM
/// 100:2008, 5.2.2). `a` and `b` may be the same scan: then every shared component is in common. Threads: any.
[[nodiscard]] ScanDifference difference_of(const CalibratedScan& a, const CalibratedPoint& in_a,
                                           const CalibratedScan& b, const CalibratedPoint& in_b);

}  // namespace gonio::calibration
