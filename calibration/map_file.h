#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace gonio::calibration {

/// A map of a detector as its file holds it: one value a pixel and layer.
///
/// The file, all little-endian, 64 bytes and the values:
///   0   8 bytes  "GONIOMAP"
///   8   uint32   1, the version of this format
///   12  uint32   width
///   16  uint32   height
///   20  uint32   layers, 1 to 4
///   24  4 x float64  standard uncertainty (k = 1) of one pixel's value, layer by layer; 0 beyond the last
///   56  uint64   FNV-1a (64 bit) of the bytes that follow
///   64  layers x height x width float32
struct MapFile {
  static constexpr int kMostLayers = 4;
  int width = 0;
  int height = 0;
  std::vector<std::vector<float>> layers;  ///< each [height][width]
  std::array<double, kMostLayers> u{};
};

/// Errors: InvalidInput (not such a file, or damaged: the sum does not agree). `name` is shown in them.
[[nodiscard]] Result<MapFile> parse_map_file(std::span<const std::uint8_t> bytes, const std::string& name);

/// The bytes of such a file. Layers have width x height values each, and there are 1 to 4 of them.
[[nodiscard]] std::string map_file_bytes(const MapFile& map);

}  // namespace gonio::calibration
