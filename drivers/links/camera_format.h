#pragma once

#include <string>

namespace gonio::drivers {

/// What a camera sends, and in what pieces.
struct CameraFormat {
  int width = 0;
  int height = 0;
  int offset_x = 0;  ///< of the region's first pixel, from the sensor's top left
  int offset_y = 0;
  std::string pixel_format;   ///< by its PFNC name, one of pixel_unpacking.h's
  int packet_size_bytes = 0;  ///< of a GigE camera; 0: the link knows no packets
  friend bool operator==(const CameraFormat&, const CameraFormat&) = default;
};

}  // namespace gonio::drivers
