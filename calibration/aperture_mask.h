#pragma once

namespace gonio::calibration {

/// The pixels that count: a circle. A pixel belongs to it when its centre does; (0, 0) is the centre of the top left
/// pixel.
struct ApertureMask {
  double centre_x_px = 0.0;
  double centre_y_px = 0.0;
  double radius_px = 0.0;
  friend bool operator==(const ApertureMask&, const ApertureMask&) = default;
};

}  // namespace gonio::calibration
