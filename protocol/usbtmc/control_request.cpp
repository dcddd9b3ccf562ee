#include "protocol/usbtmc/control_request.h"

#include <fmt/format.h>

#include "protocol/usbtmc/little_endian.h"

namespace gonio::usbtmc {
namespace {

// Lengths of the answers (USBTMC 1.0, tables 18 to 36; USB488 1.0, table 11).
constexpr std::uint16_t kInitiateBytes = 2;
constexpr std::uint16_t kAbortBytes = 8;
constexpr std::size_t kCapabilityBytes = 24;

ControlRequest of_endpoint(Request request, std::uint8_t endpoint, std::uint16_t value, std::uint16_t length) {
  return {.request_type = kOfEndpoint, .request = request, .value = value, .index = endpoint, .length = length};
}
ControlRequest of_interface(Request request, std::uint8_t number, std::uint16_t value, std::uint16_t length) {
  return {.request_type = kOfInterface, .request = request, .value = value, .index = number, .length = length};
}

tl::unexpected<Error> too_short(std::string_view what, std::size_t seen, std::size_t least) {
  return failure({.code = ErrorCode::IncompleteData,
                  .device = {},
                  .tried = fmt::format("read the answer to {}", what),
                  .seen = fmt::format("{} bytes", seen),
                  .limit = fmt::format("at least {} bytes", least)});
}

constexpr std::uint8_t bit(bool on, unsigned place) {
  return static_cast<std::uint8_t>(on ? 1U << place : 0U);
}
constexpr bool has_bit(std::uint8_t byte, unsigned place) {
  return (static_cast<unsigned>(byte) >> place & 1U) != 0;
}

}  // namespace

ControlRequest initiate_abort_bulk_out(std::uint8_t endpoint, std::uint8_t tag) {
  return of_endpoint(Request::InitiateAbortBulkOut, endpoint, tag, kInitiateBytes);
}
ControlRequest initiate_abort_bulk_in(std::uint8_t endpoint, std::uint8_t tag) {
  return of_endpoint(Request::InitiateAbortBulkIn, endpoint, tag, kInitiateBytes);
}
ControlRequest check_abort_bulk_out_status(std::uint8_t endpoint) {
  return of_endpoint(Request::CheckAbortBulkOutStatus, endpoint, 0, kAbortBytes);
}
ControlRequest check_abort_bulk_in_status(std::uint8_t endpoint) {
  return of_endpoint(Request::CheckAbortBulkInStatus, endpoint, 0, kAbortBytes);
}
ControlRequest initiate_clear(std::uint8_t interface_number) {
  return of_interface(Request::InitiateClear, interface_number, 0, 1);
}
ControlRequest check_clear_status(std::uint8_t interface_number) {
  return of_interface(Request::CheckClearStatus, interface_number, 0, 2);
}
ControlRequest get_capabilities(std::uint8_t interface_number) {
  return of_interface(Request::GetCapabilities, interface_number, 0, kCapabilityBytes);
}
ControlRequest read_status_byte(std::uint8_t interface_number, std::uint8_t tag) {
  return of_interface(Request::ReadStatusByte, interface_number, tag, 3);
}

std::array<std::uint8_t, 8> setup_bytes(const ControlRequest& request) {
  std::array<std::uint8_t, 8> bytes{request.request_type, static_cast<std::uint8_t>(request.request)};
  put16(bytes, 2, request.value);
  put16(bytes, 4, request.index);
  put16(bytes, 6, request.length);
  return bytes;
}

ControlRequest parse_setup(std::span<const std::uint8_t, 8> bytes) {
  return {.request_type = bytes[0],
          .request = static_cast<Request>(bytes[1]),
          .value = get16(bytes, 2),
          .index = get16(bytes, 4),
          .length = get16(bytes, 6)};
}

Result<Status> parse_status(std::span<const std::uint8_t> answer) {
  if (answer.empty()) return too_short("a control request", 0, 1);
  return static_cast<Status>(answer[0]);
}

Result<Progress> parse_progress(std::span<const std::uint8_t> answer) {
  if (answer.size() < 2) return too_short("a check of an abort or a clear", answer.size(), 2);
  return Progress{.status = static_cast<Status>(answer[0]), .has_data = has_bit(answer[1], 0)};
}

std::array<std::uint8_t, 24> capability_bytes(const Capabilities& capabilities) {
  std::array<std::uint8_t, 24> bytes{static_cast<std::uint8_t>(Status::Success)};
  put16(bytes, 2, capabilities.usbtmc_version);
  bytes[4] = bit(capabilities.is_talk_only, 1) | bit(capabilities.is_listen_only, 0);
  bytes[5] = bit(capabilities.stops_at_character, 0);
  put16(bytes, 12, capabilities.usb488_version);
  bytes[14] = bit(capabilities.understands_488_2, 2) | bit(capabilities.takes_trigger, 0);
  bytes[15] = bit(capabilities.understands_scpi, 3);
  return bytes;
}

Result<Capabilities> parse_capabilities(std::span<const std::uint8_t> answer) {
  if (answer.size() < kCapabilityBytes) return too_short("GET_CAPABILITIES", answer.size(), kCapabilityBytes);
  if (static_cast<Status>(answer[0]) != Status::Success) {
    return failure({.code = ErrorCode::DeviceRefused,
                    .device = {},
                    .tried = "ask for the capabilities",
                    .seen = fmt::format("status 0x{:02X}", answer[0]),
                    .limit = "0x01"});
  }
  return Capabilities{.usbtmc_version = get16(answer, 2),
                      .is_talk_only = has_bit(answer[4], 1),
                      .is_listen_only = has_bit(answer[4], 0),
                      .stops_at_character = has_bit(answer[5], 0),
                      .usb488_version = get16(answer, 12),
                      .understands_488_2 = has_bit(answer[14], 2),
                      .takes_trigger = has_bit(answer[14], 0),
                      .understands_scpi = has_bit(answer[15], 3)};
}

}  // namespace gonio::usbtmc
