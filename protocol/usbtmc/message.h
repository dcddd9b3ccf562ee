#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"

namespace gonio::usbtmc {

/// What a message on the bulk endpoints is (USBTMC 1.0, table 2; 128: USB488 1.0, table 1). The answer to a request for
/// data bears the request's number.
enum class MessageId : std::uint8_t { DevDepMsgOut = 1, DevDepMsgIn = 2, Trigger = 128 };

inline constexpr std::size_t kHeaderBytes = 12;
inline constexpr std::size_t kAlignment = 4;              ///< every Bulk-OUT message is filled up to a multiple of it
inline constexpr std::size_t kMostFillBytes = 511;        ///< behind a Bulk-IN message: less than a high-speed packet
inline constexpr std::uint32_t kMostPayload = 1U << 20U;  ///< of one transfer, ours: no radiometer says more

/// The names of transfers: 1 to 255, then 1 again; 0 is none (USBTMC 1.0, table 1).
class TagSequence {
 public:
  /// The next one.
  std::uint8_t next() { return last_ = last_ == 255 ? std::uint8_t{1} : static_cast<std::uint8_t>(last_ + 1); }

 private:
  std::uint8_t last_ = 0;
};

/// The ones' complement that follows a tag in each header.
[[nodiscard]] constexpr std::uint8_t inverse(std::uint8_t tag) {
  return static_cast<std::uint8_t>(~tag);
}

/// Host to device: a command, or a part of one. `is_end`: its last part (EOM). Filled up to a multiple of 4 bytes.
[[nodiscard]] std::vector<std::uint8_t> dev_dep_msg_out(std::uint8_t tag, std::span<const std::uint8_t> payload,
                                                        bool is_end);

/// Host to device: send at most `most` bytes. `stop_at`: end the transfer behind that character, if the device can.
[[nodiscard]] std::array<std::uint8_t, kHeaderBytes> request_dev_dep_msg_in(
    std::uint8_t tag, std::uint32_t most, std::optional<std::uint8_t> stop_at = std::nullopt);

/// Device to host: the data asked for by `tag`. Not filled up: only Bulk-OUT has to be.
[[nodiscard]] std::vector<std::uint8_t> dev_dep_msg_in(std::uint8_t tag, std::span<const std::uint8_t> payload,
                                                       bool is_end);

/// A Bulk-OUT transfer as the device takes it.
struct BulkOut {
  MessageId id = MessageId::DevDepMsgOut;
  std::uint8_t tag = 0;
  bool is_end = false;                  ///< DevDepMsgOut only
  std::vector<std::uint8_t> payload;    ///< DevDepMsgOut only
  std::uint32_t most = 0;               ///< DevDepMsgIn only: bytes that the host takes
  std::optional<std::uint8_t> stop_at;  ///< DevDepMsgIn only
};

/// Errors: IncompleteData (fewer bytes than a header, or than its size says), BadReply (unknown message, tag 0 or not
/// followed by its inverse, size 0 or beyond kMostPayload, not filled up to a multiple of 4).
[[nodiscard]] Result<BulkOut> parse_bulk_out(std::span<const std::uint8_t> bytes);

/// A Bulk-IN transfer as the host takes it.
struct BulkIn {
  bool is_end = false;
  std::vector<std::uint8_t> payload;
};

/// The answer to the request `tag` for at most `most` bytes. Up to kMostFillBytes behind the message are passed over.
/// Errors: IncompleteData (fewer bytes than a header, or than its size says), StaleData (it bears another tag),
/// BadReply (another message, a tag without its inverse, size 0 or more than asked for).
[[nodiscard]] Result<BulkIn> parse_dev_dep_msg_in(std::span<const std::uint8_t> bytes, std::uint8_t tag,
                                                  std::uint32_t most);

}  // namespace gonio::usbtmc
