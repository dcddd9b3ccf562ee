#include "drivers/links/tape/taped_modbus_link.h"

#include <utility>

#include "drivers/links/tape/exchange_bytes.h"

namespace gonio::drivers {

Result<void> TapedModbusLink::put(TapeExchange exchange, Result<void> outcome, std::span<const std::uint16_t> read) {
  if (outcome) {
    exchange.reply = bytes_of(read);
  } else {
    exchange.error = outcome.error();
  }
  channel_.put(std::move(exchange));
  return outcome;
}

Result<void> TapedModbusLink::read_registers(std::uint16_t first, std::span<std::uint16_t> into) {
  TapeExchange exchange = channel_.ask(TapeCall::ReadRegisters, request_to_read(first, into.size()));
  return put(std::move(exchange), link_.read_registers(first, into), into);
}

Result<void> TapedModbusLink::write_registers(std::uint16_t first, std::span<const std::uint16_t> words) {
  TapeExchange exchange = channel_.ask(TapeCall::WriteRegisters, request_to_write(first, words));
  return put(std::move(exchange), link_.write_registers(first, words), {});
}

Result<void> TapedModbusLink::write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words,
                                             std::uint16_t read_first, std::span<std::uint16_t> into) {
  TapeExchange exchange =
      channel_.ask(TapeCall::WriteAndRead, request_to_write_and_read(write_first, words, read_first, into.size()));
  return put(std::move(exchange), link_.write_and_read(write_first, words, read_first, into), into);
}

void TapedModbusLink::resync() {
  TapeExchange exchange = channel_.ask(TapeCall::Resync);
  link_.resync();
  channel_.put(std::move(exchange));
}

}  // namespace gonio::drivers
