#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gonio::sim {

/// GigE Vision's control protocol (GigE Vision 2.0, section 15), as much of it as a camera needs.
inline constexpr std::uint16_t kGvcpPort = 3956;

enum class GvcpCommand : std::uint16_t {
  Discovery = 0x0002,
  PacketResend = 0x0040,
  ReadRegister = 0x0080,
  WriteRegister = 0x0082,
  ReadMemory = 0x0084,
  WriteMemory = 0x0086,
};

enum class GvcpStatus : std::uint16_t {
  Success = 0x0000,
  NotImplemented = 0x8001,
  InvalidParameter = 0x8002,
  InvalidAddress = 0x8003,
  WriteProtect = 0x8004,
  BadAlignment = 0x8005,
  AccessDenied = 0x8006,
  Busy = 0x8007,
};

struct GvcpRequest {
  GvcpCommand command{};  ///< any value that was on the wire
  bool wants_acknowledge = false;
  std::uint16_t id = 0;
  std::span<const std::uint8_t> payload;  ///< of the datagram that was parsed
};

/// Nothing when it is no GVCP command or its length is not what its header says.
[[nodiscard]] std::optional<GvcpRequest> parse_gvcp(std::span<const std::uint8_t> datagram);
[[nodiscard]] std::vector<std::uint8_t> gvcp_acknowledge(const GvcpRequest& request, GvcpStatus status,
                                                         std::span<const std::uint8_t> payload);

}  // namespace gonio::sim
