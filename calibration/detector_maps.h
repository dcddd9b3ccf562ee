#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gonio::calibration {

/// What is known of each pixel of a detector. All maps: [height][width], of the frame as read; an empty one has no
/// effect. A pixel's net signal is  net = S - (offset + rate t);  the light it saw is
///   net (1 + a1 x + a2 x^2) / flat,  x = net / full scale.
struct DetectorMaps {
  int width = 0;
  int height = 0;
  std::vector<float> dark_offset_dn;
  std::vector<float> dark_rate_dn_per_s;
  std::vector<float> flat;         ///< response to even light, relative
  std::vector<float> linearity_1;  ///< a1
  std::vector<float> linearity_2;  ///< a2
  std::vector<std::uint8_t> bad;   ///< 1: never counted
  /// Standard uncertainties of one pixel's value, from the map's own noise, independent from pixel to pixel.
  double u_dark_offset_dn = 0.0;
  double u_dark_rate_dn_per_s = 0.0;
  double u_flat = 0.0;  ///< relative
  std::string version;  ///< names the maps: what a stored reading was reduced with
};

}  // namespace gonio::calibration
