#include "drivers/links/tape/replay_links.h"

#include <utility>

#include "drivers/links/tape/exchange_bytes.h"

namespace gonio::drivers {
namespace {

// The reply of a recorded exchange, or the error that was recorded in its place.
Result<TapeExchange> outcome_of(Result<TapeExchange> exchange) {
  if (exchange && exchange->error) return failure(std::move(*exchange->error));
  return exchange;
}

}  // namespace

Result<void> ReplayModbusLink::transact(TapeCall call, std::span<const std::uint8_t> request,
                                        std::span<std::uint16_t> into) {
  const Result<TapeExchange> exchange = outcome_of(player_.answer(party_, link_, call, request));
  if (!exchange) return failure(exchange.error());
  return read_words(exchange->reply, into);
}

Result<void> ReplayModbusLink::read_registers(std::uint16_t first, std::span<std::uint16_t> into) {
  return transact(TapeCall::ReadRegisters, request_to_read(first, into.size()), into);
}
Result<void> ReplayModbusLink::write_registers(std::uint16_t first, std::span<const std::uint16_t> words) {
  return transact(TapeCall::WriteRegisters, request_to_write(first, words), {});
}
Result<void> ReplayModbusLink::write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words,
                                              std::uint16_t read_first, std::span<std::uint16_t> into) {
  return transact(TapeCall::WriteAndRead, request_to_write_and_read(write_first, words, read_first, into.size()), into);
}
void ReplayModbusLink::resync() {
  (void)player_.answer(party_, link_, TapeCall::Resync, {});  // a difference stays with the player
}

Result<TapeExchange> ReplayCameraLink::ask(TapeCall call, std::span<const std::uint8_t> request) {
  return outcome_of(player_.answer(party_, link_, call, request));
}
Result<void> ReplayCameraLink::tell(TapeCall call, std::span<const std::uint8_t> request) {
  const Result<TapeExchange> told = ask(call, request);
  if (!told) return failure(told.error());
  return {};
}

Result<DetectorIdentity> ReplayCameraLink::open() {
  const Result<TapeExchange> told = ask(TapeCall::CameraOpen);
  if (!told) return failure(told.error());
  return read_identity(told->reply);
}
void ReplayCameraLink::close() {
  (void)ask(TapeCall::CameraClose);
}
bool ReplayCameraLink::is_open() const {
  return read_flag(player_.query(party_, link_, TapeCall::CameraIsOpen));
}
bool ReplayCameraLink::has_lost_control() const {
  return read_flag(player_.query(party_, link_, TapeCall::CameraHasLostControl));
}
Result<void> ReplayCameraLink::set_format(const CameraFormat& format) {
  return tell(TapeCall::CameraSetFormat, bytes_of(format));
}
Result<CameraFormat> ReplayCameraLink::format() {
  const Result<TapeExchange> told = ask(TapeCall::CameraFormatRead);
  if (!told) return failure(told.error());
  return read_format(told->reply);
}
Result<void> ReplayCameraLink::set_exposure(const ExposureSettings& settings) {
  return tell(TapeCall::CameraSetExposure, bytes_of(settings));
}
Result<ExposureSettings> ReplayCameraLink::exposure() {
  const Result<TapeExchange> told = ask(TapeCall::CameraExposureRead);
  if (!told) return failure(told.error());
  return read_exposure(told->reply);
}
Result<std::optional<double>> ReplayCameraLink::temperature_c() {
  const Result<TapeExchange> told = ask(TapeCall::CameraTemperature);
  if (!told) return failure(told.error());
  return read_number(told->reply);
}
Result<void> ReplayCameraLink::start() {
  return tell(TapeCall::CameraStart);
}
void ReplayCameraLink::stop() {
  (void)ask(TapeCall::CameraStop);
}
bool ReplayCameraLink::is_streaming() const {
  return read_flag(player_.query(party_, link_, TapeCall::CameraIsStreaming));
}
Result<void> ReplayCameraLink::trigger() {
  return tell(TapeCall::CameraTrigger);
}
Result<std::optional<CameraFrame>> ReplayCameraLink::pop(Duration /*wait*/) {
  const Result<TapeExchange> told = ask(TapeCall::CameraPop);
  if (!told) return failure(told.error());
  return read_frame(*told);
}

Result<std::vector<std::uint8_t>> ReplayUsbtmcLink::ask(TapeCall call, std::span<const std::uint8_t> request) {
  Result<TapeExchange> told = outcome_of(player_.answer(party_, link_, call, request));
  if (!told) return failure(std::move(told).error());
  return std::move(told->reply);
}

Result<DetectorIdentity> ReplayUsbtmcLink::open() {
  const Result<std::vector<std::uint8_t>> told = ask(TapeCall::UsbOpen);
  if (!told) return failure(told.error());
  return read_identity(*told);
}
void ReplayUsbtmcLink::close() {
  (void)ask(TapeCall::UsbClose);
}
bool ReplayUsbtmcLink::is_open() const {
  return read_flag(player_.query(party_, link_, TapeCall::UsbIsOpen));
}
UsbtmcInterface ReplayUsbtmcLink::interface() const {
  return read_interface(player_.query(party_, link_, TapeCall::UsbInterface)).value_or(UsbtmcInterface{});
}
Result<void> ReplayUsbtmcLink::bulk_out(std::span<const std::uint8_t> bytes, Duration /*timeout*/) {
  const Result<std::vector<std::uint8_t>> told = ask(TapeCall::UsbBulkOut, bytes);
  if (!told) return failure(told.error());
  return {};
}
Result<std::vector<std::uint8_t>> ReplayUsbtmcLink::bulk_in(std::size_t most, Duration /*timeout*/) {
  return ask(TapeCall::UsbBulkIn, request_for(most));
}
Result<std::vector<std::uint8_t>> ReplayUsbtmcLink::interrupt_in(Duration /*timeout*/) {
  return ask(TapeCall::UsbInterruptIn);
}
Result<std::vector<std::uint8_t>> ReplayUsbtmcLink::control_in(const usbtmc::ControlRequest& request,
                                                               Duration /*timeout*/) {
  return ask(TapeCall::UsbControlIn, bytes_of(request));
}
Result<void> ReplayUsbtmcLink::clear_halt(std::uint8_t endpoint) {
  const std::uint8_t request[] = {endpoint};
  const Result<std::vector<std::uint8_t>> told = ask(TapeCall::UsbClearHalt, request);
  if (!told) return failure(told.error());
  return {};
}

}  // namespace gonio::drivers
