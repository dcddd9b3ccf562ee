#include "sim/wires/rtu_frame.h"

#include <algorithm>

namespace gonio::sim {

std::uint16_t modbus_crc(std::span<const std::uint8_t> bytes) {
  constexpr std::uint16_t kPolynomial = 0xA001;  // reflected
  std::uint16_t crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ byte);
    for (int bit = 0; bit < 8; ++bit) {
      const bool carries = (crc & 1U) != 0;
      crc = static_cast<std::uint16_t>(crc >> 1U);
      if (carries) crc = static_cast<std::uint16_t>(crc ^ kPolynomial);
    }
  }
  return crc;
}

std::vector<std::uint8_t> rtu_frame(std::uint8_t unit, std::span<const std::uint8_t> pdu) {
  std::vector<std::uint8_t> frame(1 + pdu.size(), unit);
  std::copy(pdu.begin(), pdu.end(), frame.begin() + 1);
  const std::uint16_t crc = modbus_crc(frame);
  frame.push_back(static_cast<std::uint8_t>(crc));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8U));
  return frame;
}

bool has_good_crc(std::span<const std::uint8_t> frame) {
  if (frame.size() < 4) return false;
  const std::uint16_t crc = modbus_crc(frame.first(frame.size() - 2));
  return frame[frame.size() - 2] == (crc & 0xFFU) && frame.back() == crc >> 8U;
}

std::optional<std::size_t> rtu_request_length(std::span<const std::uint8_t> begin) {
  constexpr std::size_t kUnitFunctionCrc = 4;
  const auto counted_at = [&](std::size_t at) -> std::optional<std::size_t> {
    if (begin.size() <= at) return std::nullopt;
    return at + 1 + begin[at] + 2;
  };
  if (begin.size() < 2) return std::nullopt;
  switch (begin[1]) {
    case 0x01:
    case 0x02:
    case 0x03:
    case 0x04:
    case 0x05:
    case 0x06:
      return kUnitFunctionCrc + 4;
    case 0x0F:
    case 0x10:
      return counted_at(6);
    case 0x17:
      return counted_at(10);
    default:
      return std::nullopt;
  }
}

}  // namespace gonio::sim
