#pragma once

#include <cstddef>
#include <span>

#include "base/large_array.h"
#include "calibration/calibrated_scan.h"

namespace gonio::calibration {

/// What a scan's summary is made from, of one block of its points. Threads: one.
struct ScanTally {
  LargeArray<double> expanded;  ///< U of each point with a value
  LargeArray<double> relative;  ///< U/|f| of those that are not near zero
  std::size_t refused = 0;
  double frame_chi2 = 0.0;
  double frame_dof = 0.0;

  void add(const CalibratedPoint& point);
};

/// Of all blocks, added up in their order. On up to `threads` threads (0: as the machine has); the same bits for any
/// number.
[[nodiscard]] ScanSummary summary_of(std::span<const ScanTally> blocks, int threads);

}  // namespace gonio::calibration
