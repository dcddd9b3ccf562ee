#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gonio::sim {

/// The CRC of Modbus over Serial Line V1.02, 6.2.2, sent low byte first.
[[nodiscard]] std::uint16_t modbus_crc(std::span<const std::uint8_t> bytes);
/// Unit, PDU, CRC.
[[nodiscard]] std::vector<std::uint8_t> rtu_frame(std::uint8_t unit, std::span<const std::uint8_t> pdu);
/// Whether the last two bytes are the CRC of those before them.
[[nodiscard]] bool has_good_crc(std::span<const std::uint8_t> frame);
/// How long the request is that begins so, CRC included; nothing when that cannot be said, or not yet.
[[nodiscard]] std::optional<std::size_t> rtu_request_length(std::span<const std::uint8_t> begin);

inline constexpr std::size_t kLongestRtuFrame = 256;

}  // namespace gonio::sim
