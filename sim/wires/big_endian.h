#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gonio::sim {

/// Numbers as they go over GigE Vision's control channel: high byte first.
inline void append16(std::vector<std::uint8_t>& to, std::uint32_t value) {
  to.push_back(static_cast<std::uint8_t>(value >> 8U));
  to.push_back(static_cast<std::uint8_t>(value));
}
inline void append32(std::vector<std::uint8_t>& to, std::uint32_t value) {
  append16(to, value >> 16U);
  append16(to, value);
}
[[nodiscard]] inline std::uint16_t get16(std::span<const std::uint8_t> from, std::size_t at) {
  return static_cast<std::uint16_t>(from[at] << 8U | from[at + 1]);
}
[[nodiscard]] inline std::uint32_t get32(std::span<const std::uint8_t> from, std::size_t at) {
  return static_cast<std::uint32_t>(get16(from, at)) << 16U | get16(from, at + 2);
}
inline void put32(std::span<std::uint8_t> to, std::size_t at, std::uint32_t value) {
  for (std::size_t k = 0; k < 4; ++k)
    to[at + k] = static_cast<std::uint8_t>(value >> (24U - 8U * static_cast<unsigned>(k)));
}
[[nodiscard]] inline double get_double(std::span<const std::uint8_t> from, std::size_t at) {
  return std::bit_cast<double>(std::uint64_t{get32(from, at)} << 32U | get32(from, at + 4));
}
inline void put_double(std::span<std::uint8_t> to, std::size_t at, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  put32(to, at, static_cast<std::uint32_t>(bits >> 32U));
  put32(to, at + 4, static_cast<std::uint32_t>(bits));
}

}  // namespace gonio::sim
