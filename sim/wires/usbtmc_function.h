#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/clock.h"
#include "protocol/usbtmc/control_request.h"
#include "protocol/usbtmc/message.h"
#include "sim/devices/radiometer_face.h"
#include "sim/devices/radiometer_fault.h"

namespace gonio::sim {

/// What a device makes of a transfer: takes or gives the bytes, stalls, or is not ready for it.
enum class UsbOutcome : std::uint8_t { Done, Stalled, NotReady };
struct UsbAnswer {
  UsbOutcome outcome = UsbOutcome::Done;
  std::vector<std::uint8_t> bytes;
};

/// The radiometer as a USB device of one USBTMC/USB488 interface: descriptors, control requests, bulk and interrupt
/// endpoints, halts. No bus: whoever has one passes the transfers on. Threads: one at a time, as the instrument.
class UsbtmcFunction {
 public:
  static constexpr std::uint16_t kVendor = 0x1209;  ///< pid.codes, whose product 1 is for tests
  static constexpr std::uint16_t kProduct = 0x0001;
  static constexpr std::uint8_t kBulkOut = 0x01;
  static constexpr std::uint8_t kBulkIn = 0x82;
  static constexpr std::uint8_t kInterruptIn = 0x83;

  /// `face` must outlive it.
  UsbtmcFunction(RadiometerFace& face, std::string serial, bool has_interrupt_in = true);

  /// Device and configuration descriptor, one behind the other.
  [[nodiscard]] std::vector<std::uint8_t> descriptors() const;

  /// Control requests with data to the host; any other stalls.
  [[nodiscard]] UsbAnswer control(std::span<const std::uint8_t, 8> setup, Instant now);
  [[nodiscard]] UsbOutcome bulk_out(std::span<const std::uint8_t> bytes, Instant now);
  /// At most `most` bytes.
  [[nodiscard]] UsbAnswer bulk_in(std::size_t most, Instant now);
  [[nodiscard]] UsbAnswer interrupt_in();
  void clear_halt(std::uint8_t endpoint);
  /// When something that is not ready now may be.
  [[nodiscard]] std::optional<Instant> due() const { return face_.due(); }

  /// Whether a fault holds its cable out.
  [[nodiscard]] bool is_unplugged(Instant now) const { return face_.is_unplugged(now); }

  /// Lets finish what is due.
  void advance_to(Instant now) { face_.advance_to(now); }
  /// As plugged in anew.
  void power_up();
  /// Happens to the reply after the next `replies_before`, once; NotANumber and Overload to the next sample.
  void inject(RadiometerFault fault, unsigned replies_before = 0);

 private:
  struct Request {
    std::uint8_t tag = 0;
    std::uint32_t most = 0;
  };
  [[nodiscard]] UsbAnswer standard_request(const usbtmc::ControlRequest& request) const;
  [[nodiscard]] UsbAnswer class_request(const usbtmc::ControlRequest& request);
  [[nodiscard]] std::vector<std::uint8_t> string_descriptor(std::uint8_t index) const;
  [[nodiscard]] std::vector<std::uint8_t> status_answer(std::uint8_t tag);
  [[nodiscard]] std::vector<std::uint8_t> abort_bulk_in(std::uint8_t tag);
  void clear();
  [[nodiscard]] std::optional<RadiometerFault> fault_of_this_reply(Instant now);
  [[nodiscard]] UsbAnswer reply(std::size_t most, std::optional<RadiometerFault> fault);

  RadiometerFace& face_;
  std::string serial_;
  bool has_interrupt_in_;
  std::string received_;  ///< of a message that has no end yet
  std::optional<Request> request_;
  std::deque<std::vector<std::uint8_t>> notifications_;
  bool is_out_halted_ = false;
  bool is_in_halted_ = false;
  bool is_silent_ = false;
  bool ends_transfer_ = false;  ///< an abort ends it with an empty packet
  std::optional<RadiometerFault> fault_;
  unsigned replies_before_fault_ = 0;
};

}  // namespace gonio::sim
