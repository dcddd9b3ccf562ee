#pragma once

#include <cstddef>
#include <cstdint>

namespace gonio::calibration {

/// One row of pixels and of each map, all of one length.
struct MappedRow {
  const std::uint16_t* pixels = nullptr;
  const float* offset = nullptr;   ///< DN
  const float* rate = nullptr;     ///< DN/s
  const float* weight = nullptr;   ///< 1 / flat; 0: does not count
  const float* curve_1 = nullptr;  ///< 1/DN; both curves or none
  const float* curve_2 = nullptr;  ///< 1/DN^2
  std::size_t n = 0;
};

/// Sums over pixels of what the maps make of them: value = weight net (1 + curve_1 net + curve_2 net^2).
struct MapSums {
  double value = 0.0;
  double value2 = 0.0;
  double light = 0.0;  ///< weight^2 (pixel - offset): what shot noise goes with
};

/// Adds a row. In single precision within 256 pixels, in double beyond; in one order whatever the machine.
void add_mapped(const MappedRow& row, float exposure_s, MapSums& sums);

}  // namespace gonio::calibration
