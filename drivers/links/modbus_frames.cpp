#include "drivers/links/modbus_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace gonio::drivers {
namespace {

constexpr std::uint8_t kRead = 0x03;
constexpr std::uint8_t kReadInput = 0x04;
constexpr std::uint8_t kWriteOne = 0x06;
constexpr std::uint8_t kWriteSeveral = 0x10;
constexpr std::uint8_t kWriteAndRead = 0x17;
constexpr std::uint8_t kExceptionBit = 0x80;

void append(std::vector<std::uint8_t>& to, std::size_t word) {
  to.push_back(static_cast<std::uint8_t>(word >> 8U));
  to.push_back(static_cast<std::uint8_t>(word));
}

void append_counted(std::vector<std::uint8_t>& to, std::span<const std::uint16_t> words) {
  to.push_back(static_cast<std::uint8_t>(2 * words.size()));
  for (const std::uint16_t word : words) append(to, word);
}

std::uint8_t bytes_of(std::size_t words) {
  return static_cast<std::uint8_t>(2 * words);
}

// Modbus Application Protocol V1.1b3, section 7.
std::string_view exception_name(unsigned code) {
  constexpr std::array<std::string_view, 12> kNames{"",
                                                    "illegal function",
                                                    "illegal data address",
                                                    "illegal data value",
                                                    "device failure",
                                                    "acknowledge",
                                                    "device busy",
                                                    "negative acknowledge",
                                                    "memory parity error",
                                                    "",
                                                    "gateway path unavailable",
                                                    "gateway target does not respond"};
  return code < kNames.size() && !kNames[code].empty() ? kNames[code] : "not in the standard";
}

Error bad_reply(std::string seen, std::string limit) {
  return {.code = ErrorCode::BadReply, .device = {}, .tried = {}, .seen = std::move(seen), .limit = std::move(limit)};
}

}  // namespace

ModbusRequest read_request(std::uint16_t first, std::size_t count, stage::ReadFunction reads) {
  const std::uint8_t function = reads == stage::ReadFunction::Input ? kReadInput : kRead;
  ModbusRequest request{.pdu = {function}, .reply_begins = {function, bytes_of(count)}, .words_read = count};
  append(request.pdu, first);
  append(request.pdu, count);
  return request;
}

ModbusRequest write_request(std::uint16_t first, std::span<const std::uint16_t> words, stage::WriteFunction writes) {
  const bool is_single = words.size() == 1 && writes == stage::WriteFunction::Single;
  ModbusRequest request;
  request.pdu.push_back(is_single ? kWriteOne : kWriteSeveral);
  append(request.pdu, first);
  append(request.pdu, is_single ? words.front() : words.size());
  request.reply_begins = request.pdu;  // an echo
  if (!is_single) append_counted(request.pdu, words);
  return request;
}

ModbusRequest write_and_read_request(std::uint16_t write_first, std::span<const std::uint16_t> words,
                                     std::uint16_t read_first, std::size_t count) {
  ModbusRequest request{.pdu = {kWriteAndRead}, .reply_begins = {kWriteAndRead, bytes_of(count)}, .words_read = count};
  append(request.pdu, read_first);
  append(request.pdu, count);
  append(request.pdu, write_first);
  append(request.pdu, words.size());
  append_counted(request.pdu, words);
  return request;
}

Result<void> take_reply(const ModbusRequest& request, std::span<const std::uint8_t> pdu,
                        std::span<std::uint16_t> into) {
  if (pdu.size() == 2 && pdu[0] == (request.pdu[0] | kExceptionBit)) {
    return failure({.code = ErrorCode::DeviceRefused,
                    .device = {},
                    .tried = {},
                    .seen = fmt::format("exception {}: {}", pdu[1], exception_name(pdu[1])),
                    .limit = {}});
  }
  if (pdu.empty() || pdu[0] != request.pdu[0]) {
    return failure(bad_reply(fmt::format("a reply to function {}", pdu.empty() ? 0 : pdu[0]),
                             fmt::format("function {}", request.pdu[0])));
  }
  if (pdu.size() != request.reply_bytes() ||
      !std::equal(request.reply_begins.begin(), request.reply_begins.end(), pdu.begin())) {
    return failure(bad_reply(fmt::format("{} bytes, not of this request", pdu.size()),
                             fmt::format("{} bytes", request.reply_bytes())));
  }
  for (std::size_t k = 0; k < request.words_read; ++k) {
    const std::size_t at = request.reply_begins.size() + 2 * k;
    into[k] = static_cast<std::uint16_t>(pdu[at] << 8U | pdu[at + 1]);
  }
  return {};
}

}  // namespace gonio::drivers
