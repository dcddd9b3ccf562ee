#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace gonio::usbtmc {

/// Numbers as USB has them: low byte first.
[[nodiscard]] inline std::uint16_t get16(std::span<const std::uint8_t> from, std::size_t at) {
  return static_cast<std::uint16_t>(from[at] | from[at + 1] << 8U);
}
[[nodiscard]] inline std::uint32_t get32(std::span<const std::uint8_t> from, std::size_t at) {
  return get16(from, at) | static_cast<std::uint32_t>(get16(from, at + 2)) << 16U;
}
inline void put16(std::span<std::uint8_t> to, std::size_t at, std::uint16_t value) {
  to[at] = static_cast<std::uint8_t>(value);
  to[at + 1] = static_cast<std::uint8_t>(value >> 8U);
}
inline void put32(std::span<std::uint8_t> to, std::size_t at, std::uint32_t value) {
  put16(to, at, static_cast<std::uint16_t>(value));
  put16(to, at + 2, static_cast<std::uint16_t>(value >> 16U));
}

}  // namespace gonio::usbtmc
