#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "reflectance/measured/compare_scans.h"

namespace gonio::reflectance {

/// One geometry that several scans have.
struct RepeatedPoint {
  Geometry geometry;
  std::size_t count = 0;
  Brdf mean;
  Brdf scatter;   ///< standard deviation of one value about the mean, with count - 1
  Brdf u_random;  ///< root mean square of what the scans state for it
  Brdf u;         ///< likewise with what each scan draws anew (components without a source): what scatter should be
};

/// One scan among the others.
struct ScanOffset {
  std::string name;
  std::size_t points = 0;    ///< that other scans have, too
  double mean_offset = 0.0;  ///< relative, from the means of the geometries, each counting by the size of its mean
};

struct Repeatability {
  std::vector<RepeatedPoint> points;
  std::vector<ScanOffset> scans;
  double relative_scatter = 0.0;  ///< root of the pooled relative variance: of geometries with a mean above 3 u_random
  double relative_between = 0.0;  ///< of that: how the scans' mean offsets scatter, as with a certificate drawn anew
  double relative_within = 0.0;   ///< what is left when each scan's offset is taken out of its values
  double chi2 = 0.0;              ///< of all values about their geometries' means, with what the scans share
  std::size_t degrees_of_freedom = 0;
  double p_value = 1.0;
};

/// How well the scans of a campaign repeat. Only what does not cancel counts, as for compare_scans. Errors:
/// InvalidInput for fewer than two scans or no geometry that two of them have; else as compare_scans.
[[nodiscard]] Result<Repeatability> repeatability(std::span<const MeasuredScan> scans,
                                                  const CompareOptions& options = {});

}  // namespace gonio::reflectance
