#include "protocol/usbtmc/message.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "protocol/usbtmc/little_endian.h"

namespace gonio::usbtmc {
namespace {

// Places in a header (USBTMC 1.0, tables 1, 3, 4 and 9).
constexpr std::size_t kSizeAt = 4;
constexpr std::size_t kAttributesAt = 8;
constexpr std::size_t kStopCharacterAt = 9;
constexpr unsigned kEndOfMessage = 1;
constexpr unsigned kStopCharacterOn = 2;

using Header = std::array<std::uint8_t, kHeaderBytes>;

Header header(MessageId id, std::uint8_t tag, std::uint32_t size, unsigned attributes) {
  assert(tag != 0 && size != 0);
  Header bytes{static_cast<std::uint8_t>(id), tag, inverse(tag)};
  put32(bytes, kSizeAt, size);
  bytes[kAttributesAt] = static_cast<std::uint8_t>(attributes);
  return bytes;
}

std::vector<std::uint8_t> with_payload(const Header& header, std::span<const std::uint8_t> payload) {
  std::vector<std::uint8_t> bytes(header.begin(), header.end());
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return bytes;
}

tl::unexpected<Error> bad(ErrorCode code, std::string_view what, std::string seen, std::string limit) {
  return failure({.code = code,
                  .device = {},
                  .tried = fmt::format("read the USBTMC header of a {}", what),
                  .seen = std::move(seen),
                  .limit = std::move(limit)});
}

// What both directions share: a whole header, and a tag that is followed by its inverse.
Result<void> check_header(std::span<const std::uint8_t> bytes, std::string_view what) {
  if (bytes.size() < kHeaderBytes) {
    return bad(ErrorCode::IncompleteData, what, fmt::format("{} bytes", bytes.size()),
               fmt::format("at least {} bytes", kHeaderBytes));
  }
  if (bytes[1] == 0 || bytes[2] != inverse(bytes[1])) {
    return bad(ErrorCode::BadReply, what, fmt::format("tag {} followed by {}", bytes[1], bytes[2]),
               fmt::format("tag 1 to 255 followed by its inverse ({})", inverse(bytes[1])));
  }
  return {};
}

Result<void> check_size(std::uint32_t size, std::uint32_t most, std::string_view what) {
  if (size >= 1 && size <= most) return {};
  return bad(ErrorCode::BadReply, what, fmt::format("size {} bytes", size), fmt::format("1 to {} bytes", most));
}

Result<void> check_payload(std::span<const std::uint8_t> bytes, std::uint32_t size, std::string_view what) {
  const std::size_t there = bytes.size() - kHeaderBytes;
  if (there >= size) return {};
  return bad(ErrorCode::IncompleteData, what, fmt::format("{} bytes of data", there),
             fmt::format("{} bytes as its header says", size));
}

Result<BulkOut> parse_command(BulkOut out, std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kWhat = "command";
  const std::uint32_t size = get32(bytes, kSizeAt);
  GONIO_TRY(check_size(size, kMostPayload, kWhat));
  GONIO_TRY(check_payload(bytes, size, kWhat));
  const std::size_t filled = (kHeaderBytes + size + kAlignment - 1) / kAlignment * kAlignment;
  if (bytes.size() != filled) {
    return bad(ErrorCode::BadReply, kWhat, fmt::format("{} bytes", bytes.size()), fmt::format("{} bytes", filled));
  }
  const auto payload = bytes.subspan(kHeaderBytes, size);
  out.payload.assign(payload.begin(), payload.end());
  out.is_end = (bytes[kAttributesAt] & kEndOfMessage) != 0;
  return out;
}

Result<BulkOut> parse_request(BulkOut out, std::span<const std::uint8_t> bytes) {
  out.most = get32(bytes, kSizeAt);
  if (out.most == 0) return bad(ErrorCode::BadReply, "request", "size 0 bytes", "at least 1 byte");
  if ((bytes[kAttributesAt] & kStopCharacterOn) != 0) out.stop_at = bytes[kStopCharacterAt];
  return out;
}

}  // namespace

std::vector<std::uint8_t> dev_dep_msg_out(std::uint8_t tag, std::span<const std::uint8_t> payload, bool is_end) {
  assert(payload.size() <= kMostPayload);
  std::vector<std::uint8_t> bytes = with_payload(
      header(MessageId::DevDepMsgOut, tag, static_cast<std::uint32_t>(payload.size()), is_end ? kEndOfMessage : 0U),
      payload);
  bytes.resize((bytes.size() + kAlignment - 1) / kAlignment * kAlignment, 0);
  return bytes;
}

std::array<std::uint8_t, kHeaderBytes> request_dev_dep_msg_in(std::uint8_t tag, std::uint32_t most,
                                                              std::optional<std::uint8_t> stop_at) {
  Header bytes = header(MessageId::DevDepMsgIn, tag, most, stop_at ? kStopCharacterOn : 0U);
  bytes[kStopCharacterAt] = stop_at.value_or(0);
  return bytes;
}

std::vector<std::uint8_t> dev_dep_msg_in(std::uint8_t tag, std::span<const std::uint8_t> payload, bool is_end) {
  return with_payload(
      header(MessageId::DevDepMsgIn, tag, static_cast<std::uint32_t>(payload.size()), is_end ? kEndOfMessage : 0U),
      payload);
}

Result<BulkOut> parse_bulk_out(std::span<const std::uint8_t> bytes) {
  GONIO_TRY(check_header(bytes, "Bulk-OUT transfer"));
  BulkOut out{.id = static_cast<MessageId>(bytes[0]), .tag = bytes[1], .payload = {}};
  switch (out.id) {
    case MessageId::DevDepMsgOut:
      return parse_command(std::move(out), bytes);
    case MessageId::DevDepMsgIn:
      return parse_request(std::move(out), bytes);
    case MessageId::Trigger:
      return out;
  }
  return bad(ErrorCode::BadReply, "Bulk-OUT transfer", fmt::format("message {}", bytes[0]), "message 1, 2 or 128");
}

Result<BulkIn> parse_dev_dep_msg_in(std::span<const std::uint8_t> bytes, std::uint8_t tag, std::uint32_t most) {
  constexpr std::string_view kWhat = "reply";
  GONIO_TRY(check_header(bytes, kWhat));
  if (static_cast<MessageId>(bytes[0]) != MessageId::DevDepMsgIn) {
    return bad(ErrorCode::BadReply, kWhat, fmt::format("message {}", bytes[0]), "message 2");
  }
  if (bytes[1] != tag) {
    return bad(ErrorCode::StaleData, kWhat, fmt::format("tag {}", bytes[1]), fmt::format("tag {}", tag));
  }
  const std::uint32_t size = get32(bytes, kSizeAt);
  GONIO_TRY(check_size(size, most, kWhat));
  GONIO_TRY(check_payload(bytes, size, kWhat));
  if (bytes.size() - kHeaderBytes - size > kMostFillBytes) {
    return bad(ErrorCode::BadReply, kWhat, fmt::format("{} bytes behind the data", bytes.size() - kHeaderBytes - size),
               fmt::format("at most {} bytes", kMostFillBytes));
  }
  const auto payload = bytes.subspan(kHeaderBytes, size);
  return BulkIn{.is_end = (bytes[kAttributesAt] & kEndOfMessage) != 0, .payload = {payload.begin(), payload.end()}};
}

}  // namespace gonio::usbtmc
