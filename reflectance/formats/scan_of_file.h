#pragma once

#include <cstdint>

#include "base/result.h"
#include "reflectance/formats/measured_brdf.h"
#include "reflectance/measured/measured_scan.h"

namespace gonio::formats {

/// The points of one channel as a scan: what quantities, fits and comparisons take (reflectance/measured). U/k is split
/// as the file tells it: u_shared_per_sr becomes one component that all points share, its source being the file's
/// references (none: its own), the rest u_random; 0 where the file knows none. Points of another channel keep their
/// place, flagged, so that an index of the scan is one of `brdf.points`; so do points with any of the flags in
/// `left_out`. Errors: as `check`; InvalidInput for a channel that is not in the list.
[[nodiscard]] Result<reflectance::MeasuredScan> scan_of(const MeasuredBrdf& brdf, std::size_t channel,
                                                        std::uint32_t left_out = 0);

}  // namespace gonio::formats
