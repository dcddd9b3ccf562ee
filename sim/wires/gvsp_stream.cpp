#include "sim/wires/gvsp_stream.h"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>

#include "sim/wires/big_endian.h"
#include "sim/wires/camera_registers.h"
#include "sim/wires/pixel_packing.h"

namespace gonio::sim {
namespace {

constexpr std::size_t kHeaders = 20 + 8 + 8;  // IP, UDP, GVSP
constexpr std::size_t kKept = 8;              // frames to resend from
constexpr std::uint32_t kBurst = 16;          // packets in a row
constexpr double kBytesPerSecond = 100e6;     // a receive buffer of the usual 200 kB keeps up with it
constexpr std::uint32_t kImage = 1;           // payload type
enum Format : std::uint8_t { Leader = 1, Trailer = 2, Data = 3 };

std::vector<std::uint8_t> leader_of(const CameraFrame& frame, const SentRegion& region) {
  constexpr std::uint64_t kNsPerTick = 1000000000 / kTicksPerSecond;
  const auto ticks = static_cast<std::uint64_t>(frame.exposure_end.time_since_epoch().count()) / kNsPerTick;
  std::vector<std::uint8_t> leader;
  append32(leader, kImage);
  append32(leader, static_cast<std::uint32_t>(ticks >> 32U));
  append32(leader, static_cast<std::uint32_t>(ticks));
  append32(leader, region.pixel_format);
  for (const int value : {region.width, region.height, region.offset_x, region.offset_y}) {
    append32(leader, static_cast<std::uint32_t>(value));
  }
  append32(leader, 0);  // padding
  return leader;
}

std::vector<std::uint8_t> trailer_of(const SentRegion& region) {
  std::vector<std::uint8_t> trailer;
  append32(trailer, kImage);
  append32(trailer, static_cast<std::uint32_t>(region.height));
  return trailer;
}

std::vector<std::uint8_t> bytes_of(const CameraFrame& frame, const SentRegion& region) {
  std::vector<std::uint16_t> pixels;
  pixels.reserve(static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height));
  for (int y = region.offset_y; y < region.offset_y + region.height; ++y) {
    const auto row = frame.pixels.begin() + std::ptrdiff_t{y} * frame.width + region.offset_x;
    pixels.insert(pixels.end(), row, row + region.width);
  }
  return packed_bytes(*sent_format(region.pixel_format), pixels);
}

}  // namespace

std::uint32_t GvspStream::Block::last_packet() const {
  return static_cast<std::uint32_t>((data.size() + payload_size - 1) / payload_size) + 1;
}

void GvspStream::add(const CameraFrame& frame, const SentRegion& region, std::size_t packet_size,
                     const sockaddr_in& receiver) {
  constexpr std::uint64_t kBlockIds = 65535;  // 0 is no block
  while (blocks_.size() >= kKept) blocks_.pop_front();
  blocks_.push_back({.id = static_cast<std::uint16_t>((frame.frame_id - 1) % kBlockIds + 1),
                     .payload_size = packet_size - kHeaders,
                     .receiver = receiver,
                     .leader = leader_of(frame, region),
                     .data = bytes_of(frame, region),
                     .trailer = trailer_of(region),
                     .loss = std::exchange(next_loss_, {})});
}

void GvspStream::send_packet(int socket, const Block& block, std::uint32_t packet, bool is_resent) {
  if (block.loss.takes(packet) && (!is_resent || block.loss.is_for_good)) return;
  std::span<const std::uint8_t> part = block.leader;
  std::uint8_t format = Leader;
  if (packet == block.last_packet()) {
    part = block.trailer;
    format = Trailer;
  } else if (packet > 0) {
    const std::size_t from = (packet - 1) * block.payload_size;
    part = std::span(block.data).subspan(from, std::min(block.payload_size, block.data.size() - from));
    format = Data;
  }
  std::vector<std::uint8_t> datagram;
  datagram.reserve(8 + part.size());
  append16(datagram, is_resent ? 0x0100 : 0x0000);
  append16(datagram, block.id);
  append32(datagram, std::uint32_t{format} << 24U | packet);
  datagram.insert(datagram.end(), part.begin(), part.end());
  // A datagram that does not go out is a lost one: the receiver asks for it again.
  ::sendto(socket, datagram.data(), datagram.size(), MSG_DONTWAIT, reinterpret_cast<const sockaddr*>(&block.receiver),
           sizeof block.receiver);
}

void GvspStream::resend(int socket, std::uint16_t block_id, std::uint32_t first, std::uint32_t last) {
  const auto block = std::ranges::find(blocks_, block_id, &Block::id);
  if (block == blocks_.end()) return;
  for (std::uint32_t packet = first; packet <= std::min(last, block->last_packet()); ++packet) {
    send_packet(socket, *block, packet, true);
  }
}

std::optional<Instant> GvspStream::send_due(int socket, Instant now) {
  const auto unsent = std::ranges::find_if(blocks_, [](const Block& b) { return b.next_packet <= b.last_packet(); });
  if (unsent == blocks_.end()) return std::nullopt;
  if (now < next_send_) return next_send_;
  std::size_t bytes = 0;
  for (std::uint32_t k = 0; k < kBurst && unsent->next_packet <= unsent->last_packet(); ++k) {
    send_packet(socket, *unsent, unsent->next_packet++, false);
    bytes += unsent->payload_size + kHeaders;
  }
  next_send_ = now + seconds(static_cast<double>(bytes) / kBytesPerSecond);
  return next_send_;
}

void GvspStream::clear() {
  blocks_.clear();
}

}  // namespace gonio::sim
