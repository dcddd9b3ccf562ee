#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "sim/devices/camera_model.h"

namespace gonio::sim {

/// What of a frame is sent, and how; inside of it.
struct SentRegion {
  int width = 0;
  int height = 0;
  int offset_x = 0;
  int offset_y = 0;
  std::uint32_t pixel_format = 0;  ///< of sent_formats()
};

/// Frames on their way to one receiver as GVSP packets (GigE Vision 2.0, section 24): paced, so that a small receive
/// buffer does not overflow, and kept for a while to be sent again. Threads: owned by one.
class GvspStream {
 public:
  /// `packet_size` counts IP, UDP and GVSP headers. The frame's id, modulo 65535, is its block id. The region's pixels
  /// are sent, in this format.
  void add(const CameraFrame& frame, const SentRegion& region, std::size_t packet_size, const sockaddr_in& receiver);
  /// For faults: of the next frame the packets 2 to `count` + 1 are lost on their way, for good or until asked for.
  void lose_packets(std::uint32_t count, bool for_good) { next_loss_ = {count, for_good}; }
  /// Packets that were lost on the way. Unknown frames are ignored.
  void resend(int socket, std::uint16_t block_id, std::uint32_t first, std::uint32_t last);

  /// Sends what is due. Returns when to come again, or nothing when all is sent.
  std::optional<Instant> send_due(int socket, Instant now);
  /// Forgets everything.
  void clear();

 private:
  struct Loss {
    std::uint32_t packets = 0;
    bool is_for_good = false;
    [[nodiscard]] bool takes(std::uint32_t packet) const { return packet >= 2 && packet < 2 + packets; }
  };
  struct Block {
    std::uint16_t id = 0;
    std::size_t payload_size = 0;  ///< of one packet
    sockaddr_in receiver{};
    std::vector<std::uint8_t> leader;
    std::vector<std::uint8_t> data;
    std::vector<std::uint8_t> trailer;
    Loss loss;
    std::uint32_t next_packet = 0;
    [[nodiscard]] std::uint32_t last_packet() const;
  };
  static void send_packet(int socket, const Block& block, std::uint32_t packet, bool is_resent);

  std::deque<Block> blocks_;  ///< the oldest first; all but the last few are sent
  Instant next_send_{};
  Loss next_loss_;
};

}  // namespace gonio::sim
