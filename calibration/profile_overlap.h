#pragma once

#include <optional>

#include "base/geometry.h"
#include "calibration/overlap_model.h"

namespace gonio::calibration {

/// O = integral e w dA over a target of this radius (none: endless), in mm^2 times the values of both profiles: `e` of
/// the source across its beam, `w` of the detector across its own, each by its measured profile or evenly 1 within its
/// radius. Along each azimuth both profiles are straight between nodes, so that the integral along the radius is exact;
/// the one over azimuth is Gauss-Kronrod (7, 15), halved until its error is below 1e-10 of the whole. Threads: any.
[[nodiscard]] double profile_overlap_mm2(const OverlapModel& model, std::optional<Length> target_radius,
                                         const Geometry& g);

}  // namespace gonio::calibration
