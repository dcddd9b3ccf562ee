#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace gonio::test {

/// The bytes of a map's file, written from the format's description (calibration/map_file.h) and not by the code that
/// reads it.
inline std::vector<std::uint8_t> map_bytes(int width, int height, const std::vector<std::vector<float>>& layers,
                                           std::array<double, 4> u = {}) {
  std::vector<std::uint8_t> values;
  const auto append = [](std::vector<std::uint8_t>& to, std::uint64_t word, int bytes) {
    for (int k = 0; k < bytes; ++k) to.push_back(static_cast<std::uint8_t>(word >> (8 * k)));
  };
  for (const auto& layer : layers) {
    for (const float value : layer) append(values, std::bit_cast<std::uint32_t>(value), 4);
  }
  std::uint64_t sum = 0xcbf29ce484222325;
  for (const std::uint8_t byte : values) sum = (sum ^ byte) * 0x100000001b3;
  std::vector<std::uint8_t> bytes{'G', 'O', 'N', 'I', 'O', 'M', 'A', 'P'};
  append(bytes, 1, 4);
  append(bytes, static_cast<std::uint64_t>(width), 4);
  append(bytes, static_cast<std::uint64_t>(height), 4);
  append(bytes, layers.size(), 4);
  for (const double one : u) append(bytes, std::bit_cast<std::uint64_t>(one), 8);
  append(bytes, sum, 8);
  bytes.insert(bytes.end(), values.begin(), values.end());
  return bytes;
}

}  // namespace gonio::test
