#pragma once

#include <cstddef>
#include <vector>

#include "base/result.h"
#include "daemon/analysis/stored_scan.h"
#include "reflectance/formats/measured_brdf.h"
#include "reflectance/measured/measured_scan.h"

namespace gonio::analysis {

/// The values of one channel as the data that fits, integrals and comparisons take. Of a stored scan each component of
/// the budget stays one; what other scans have too (certificate, arms' zeros) is named by the standard's file or the
/// instrument, so that it cancels between two scans. Errors: InvalidInput for a channel that there is not.
[[nodiscard]] Result<reflectance::MeasuredScan> scan_data(const StoredScan& scan, const formats::MeasuredBrdf& brdf,
                                                          std::size_t channel);

}  // namespace gonio::analysis
