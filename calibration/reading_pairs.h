#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calibration/raw_reading.h"

namespace gonio::calibration {

/// The readings that make one point; null where there is none.
struct ReadingPair {
  const RawReading* sample = nullptr;
  const RawReading* reference = nullptr;
  bool is_borrowed = false;  ///< the reference was read for another point at the same place
  bool is_shared = false;    ///< the reference serves more than one point
};

/// Which readings make which point: the last reading of a point and target counts; a point without a reference reading
/// of its own takes that of another one at the same place, where the standard, which is isotropic, gives the same:
/// wavelength, polarisation, thetas, |dphi|, all to 0.001 deg and 0.001 nm.
/// [n]: of scan.points[n]. The pointers live as long as the scan. O(n).
[[nodiscard]] std::vector<ReadingPair> pair_readings(const ScanReadings& scan);

}  // namespace gonio::calibration
