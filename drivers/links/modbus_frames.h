#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "drivers/links/modbus_unit.h"

namespace gonio::drivers {

/// One Modbus transaction as bytes without the wire's own framing (Modbus Application Protocol
/// V1.1b3, 6.3, 6.4, 6.6, 6.12, 6.17). Pure.
struct ModbusRequest {
  std::vector<std::uint8_t> pdu;
  std::vector<std::uint8_t> reply_begins;  ///< what a reply to it begins with; a reply to a write is this and no more
  std::size_t words_read = 0;              ///< which follow in the reply
  [[nodiscard]] std::size_t reply_bytes() const { return reply_begins.size() + 2 * words_read; }
};

[[nodiscard]] ModbusRequest read_request(std::uint16_t first, std::size_t count,
                                         stage::ReadFunction reads = stage::ReadFunction::Holding);
/// One word by the unit's function, more by FC16.
[[nodiscard]] ModbusRequest write_request(std::uint16_t first, std::span<const std::uint16_t> words,
                                          stage::WriteFunction writes = stage::WriteFunction::Single);
[[nodiscard]] ModbusRequest write_and_read_request(std::uint16_t write_first, std::span<const std::uint16_t> words,
                                                   std::uint16_t read_first, std::size_t count);

/// Takes the words out of a reply. Errors: DeviceRefused (an exception, in words), BadReply (to something else).
[[nodiscard]] Result<void> take_reply(const ModbusRequest& request, std::span<const std::uint8_t> pdu,
                                      std::span<std::uint16_t> into);

}  // namespace gonio::drivers
