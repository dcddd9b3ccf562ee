#pragma once

#include <cstdint>
#include <span>

#include "base/result.h"
#include "calibration/raw_reading.h"

namespace gonio::calibration {

/// The pixels that count: a circle. A pixel belongs to it when its centre does; (0, 0) is the centre of the top left
/// pixel.
struct ApertureMask {
  double centre_x_px = 0.0;
  double centre_y_px = 0.0;
  double radius_px = 0.0;
  friend bool operator==(const ApertureMask&, const ApertureMask&) = default;
};

/// Condenses a frame to the statistics inside the mask, in one pass over it: nothing subtracted, nothing clipped.
/// `pixels` is row by row, top left first: [height][width], in DN. Pixels at `full_scale` or above count as saturated.
/// The moments are central from the start (each row about its own mean, rows merged after Pebay 2008, eqs 2.1-2.9), so
/// that a bright, even frame keeps all digits. The same bits whenever the same frame comes.
/// Errors: IncompleteData (not width x height pixels), OutOfLimits (the mask is empty or reaches out of the frame).
[[nodiscard]] Result<RegionMoments> reduce_frame(std::span<const std::uint16_t> pixels, int width, int height,
                                                 std::uint16_t full_scale, const ApertureMask& mask);

}  // namespace gonio::calibration
