#include "sim/wires/gvcp.h"

#include "sim/wires/big_endian.h"

namespace gonio::sim {
namespace {

constexpr std::uint8_t kKey = 0x42;
constexpr std::uint8_t kAcknowledgeFlag = 0x01;
constexpr std::size_t kGvcpHeader = 8;

}  // namespace

std::optional<GvcpRequest> parse_gvcp(std::span<const std::uint8_t> datagram) {
  if (datagram.size() < kGvcpHeader || datagram[0] != kKey) return std::nullopt;
  const std::size_t length = get16(datagram, 4);
  if (datagram.size() != kGvcpHeader + length) return std::nullopt;
  return GvcpRequest{.command = static_cast<GvcpCommand>(get16(datagram, 2)),
                     .wants_acknowledge = (datagram[1] & kAcknowledgeFlag) != 0,
                     .id = get16(datagram, 6),
                     .payload = datagram.subspan(kGvcpHeader)};
}

std::vector<std::uint8_t> gvcp_acknowledge(const GvcpRequest& request, GvcpStatus status,
                                           std::span<const std::uint8_t> payload) {
  std::vector<std::uint8_t> datagram;
  append16(datagram, static_cast<std::uint16_t>(status));
  append16(datagram, static_cast<std::uint32_t>(request.command) + 1U);
  append16(datagram, static_cast<std::uint32_t>(payload.size()));
  append16(datagram, request.id);
  datagram.insert(datagram.end(), payload.begin(), payload.end());
  return datagram;
}

}  // namespace gonio::sim
