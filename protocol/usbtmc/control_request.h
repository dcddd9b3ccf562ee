#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace gonio::usbtmc {

/// Requests of the class on the control endpoint (USBTMC 1.0, table 15; from 128 on USB488 1.0, table 9).
enum class Request : std::uint8_t {
  InitiateAbortBulkOut = 1,
  CheckAbortBulkOutStatus = 2,
  InitiateAbortBulkIn = 3,
  CheckAbortBulkInStatus = 4,
  InitiateClear = 5,
  CheckClearStatus = 6,
  GetCapabilities = 7,
  ReadStatusByte = 128,
};

/// The first byte of each answer (USBTMC 1.0, table 16; 0x20: USB488 1.0, table 10).
enum class Status : std::uint8_t {
  Success = 0x01,
  Pending = 0x02,
  InterruptInBusy = 0x20,
  Failed = 0x80,
  TransferNotInProgress = 0x81,
  SplitNotInProgress = 0x82,
  SplitInProgress = 0x83,
};

/// A control request that fetches `length` bytes at most. `index` is the interface, for the aborts the endpoint.
struct ControlRequest {
  std::uint8_t request_type = 0;  ///< 0xA1: class, of an interface; 0xA2: class, of an endpoint; both device to host
  Request request = Request::GetCapabilities;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;
  friend bool operator==(const ControlRequest&, const ControlRequest&) = default;
};

inline constexpr std::uint8_t kOfInterface = 0xA1;
inline constexpr std::uint8_t kOfEndpoint = 0xA2;

/// Ends the transfer `tag`. Answer: status, then the tag of the transfer under way.
[[nodiscard]] ControlRequest initiate_abort_bulk_out(std::uint8_t endpoint, std::uint8_t tag);
[[nodiscard]] ControlRequest initiate_abort_bulk_in(std::uint8_t endpoint, std::uint8_t tag);
/// How far it is. Answer of 8 bytes, see `AbortProgress`.
[[nodiscard]] ControlRequest check_abort_bulk_out_status(std::uint8_t endpoint);
[[nodiscard]] ControlRequest check_abort_bulk_in_status(std::uint8_t endpoint);
/// Empties the device's buffers for both directions. Answer: status.
[[nodiscard]] ControlRequest initiate_clear(std::uint8_t interface_number);
/// Answer: status, then bit 0: Bulk-IN still holds data.
[[nodiscard]] ControlRequest check_clear_status(std::uint8_t interface_number);
[[nodiscard]] ControlRequest get_capabilities(std::uint8_t interface_number);
/// `tag` 2 to 127. Answer: status, tag, status byte; the last is 0 where there is an Interrupt-IN endpoint, on which it
/// then comes as (0x80 + tag, status byte).
[[nodiscard]] ControlRequest read_status_byte(std::uint8_t interface_number, std::uint8_t tag);

/// The tags of READ_STATUS_BYTE: 2 to 127, then 2 again (USB488 1.0, 4.3.1).
class StatusTagSequence {
 public:
  std::uint8_t next() { return last_ = last_ >= 127 ? std::uint8_t{2} : static_cast<std::uint8_t>(last_ + 1); }

 private:
  std::uint8_t last_ = 1;
};

/// The 8 bytes that start a control transfer.
[[nodiscard]] std::array<std::uint8_t, 8> setup_bytes(const ControlRequest& request);
[[nodiscard]] ControlRequest parse_setup(std::span<const std::uint8_t, 8> bytes);

/// How far an abort or a clear is. `has_data`: the host shall read Bulk-IN before it asks again.
struct Progress {
  Status status = Status::Failed;
  bool has_data = false;
};
/// Answers of CheckClearStatus and CheckAbortBulkInStatus, of which the first two bytes tell. Errors: IncompleteData.
[[nodiscard]] Result<Progress> parse_progress(std::span<const std::uint8_t> answer);
/// The first byte of any answer. Errors: IncompleteData (there is none).
[[nodiscard]] Result<Status> parse_status(std::span<const std::uint8_t> answer);

/// What the interface can do, of its 24 bytes (USBTMC 1.0, table 37; USB488 1.0, table 8).
struct Capabilities {
  std::uint16_t usbtmc_version = 0;  ///< binary coded decimal: 0x0100
  bool is_talk_only = false;
  bool is_listen_only = false;
  bool stops_at_character = false;
  std::uint16_t usb488_version = 0;
  bool understands_488_2 = false;
  bool takes_trigger = false;
  bool understands_scpi = false;
  friend bool operator==(const Capabilities&, const Capabilities&) = default;
};
[[nodiscard]] std::array<std::uint8_t, 24> capability_bytes(const Capabilities& capabilities);
/// Errors: IncompleteData (fewer than 24 bytes), DeviceRefused (its status is not success).
[[nodiscard]] Result<Capabilities> parse_capabilities(std::span<const std::uint8_t> answer);

/// Bits of the status byte (IEEE 488.2-1992, 11.2; bit 2: SCPI-99, volume 1, 9.2).
inline constexpr std::uint8_t kErrorAvailable = 0x04;
inline constexpr std::uint8_t kMessageAvailable = 0x10;

}  // namespace gonio::usbtmc
