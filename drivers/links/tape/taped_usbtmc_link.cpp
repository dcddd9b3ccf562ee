#include "drivers/links/tape/taped_usbtmc_link.h"

#include <utility>

#include "drivers/links/tape/exchange_bytes.h"

namespace gonio::drivers {
namespace {

Result<void> put_usb(const TapeChannel& channel, TapeExchange exchange, Result<void> outcome) {
  if (!outcome) exchange.error = outcome.error();
  channel.put(std::move(exchange));
  return outcome;
}

Result<std::vector<std::uint8_t>> put_usb(const TapeChannel& channel, TapeExchange exchange,
                                          Result<std::vector<std::uint8_t>> outcome) {
  if (outcome) {
    exchange.reply = *outcome;
  } else {
    exchange.error = outcome.error();
  }
  channel.put(std::move(exchange));
  return outcome;
}

}  // namespace

Result<DetectorIdentity> TapedUsbtmcLink::open() {
  TapeExchange exchange = channel_.ask(TapeCall::UsbOpen);
  Result<DetectorIdentity> identity = link_.open();
  if (identity) {
    exchange.reply = bytes_of(*identity);
  } else {
    exchange.error = identity.error();
  }
  channel_.put(std::move(exchange));
  return identity;
}

void TapedUsbtmcLink::close() {
  TapeExchange exchange = channel_.ask(TapeCall::UsbClose);
  link_.close();
  channel_.put(std::move(exchange));
}

bool TapedUsbtmcLink::is_open() const {
  TapeExchange exchange = channel_.ask(TapeCall::UsbIsOpen);
  const bool answer = link_.is_open();
  exchange.reply = bytes_of(answer);
  channel_.put(std::move(exchange));
  return answer;
}

UsbtmcInterface TapedUsbtmcLink::interface() const {
  TapeExchange exchange = channel_.ask(TapeCall::UsbInterface);
  const UsbtmcInterface answer = link_.interface();
  exchange.reply = bytes_of(answer);
  channel_.put(std::move(exchange));
  return answer;
}

// Timeouts are no part of a request: nothing of them goes over the wire.
Result<void> TapedUsbtmcLink::bulk_out(std::span<const std::uint8_t> bytes, Duration timeout) {
  TapeExchange exchange = channel_.ask(TapeCall::UsbBulkOut, {bytes.begin(), bytes.end()});
  return put_usb(channel_, std::move(exchange), link_.bulk_out(bytes, timeout));
}

Result<std::vector<std::uint8_t>> TapedUsbtmcLink::bulk_in(std::size_t most, Duration timeout) {
  TapeExchange exchange = channel_.ask(TapeCall::UsbBulkIn, request_for(most));
  return put_usb(channel_, std::move(exchange), link_.bulk_in(most, timeout));
}

Result<std::vector<std::uint8_t>> TapedUsbtmcLink::interrupt_in(Duration timeout) {
  TapeExchange exchange = channel_.ask(TapeCall::UsbInterruptIn);
  return put_usb(channel_, std::move(exchange), link_.interrupt_in(timeout));
}

Result<std::vector<std::uint8_t>> TapedUsbtmcLink::control_in(const usbtmc::ControlRequest& request, Duration timeout) {
  TapeExchange exchange = channel_.ask(TapeCall::UsbControlIn, bytes_of(request));
  return put_usb(channel_, std::move(exchange), link_.control_in(request, timeout));
}

Result<void> TapedUsbtmcLink::clear_halt(std::uint8_t endpoint) {
  TapeExchange exchange = channel_.ask(TapeCall::UsbClearHalt, {endpoint});
  return put_usb(channel_, std::move(exchange), link_.clear_halt(endpoint));
}

}  // namespace gonio::drivers
