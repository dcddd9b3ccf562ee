#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "drivers/detector.h"
#include "protocol/usbtmc/control_request.h"

namespace gonio::drivers {

/// Where a USBTMC interface is to be talked to.
struct UsbtmcInterface {
  std::uint8_t number = 0;
  std::uint8_t bulk_out = 0;
  std::uint8_t bulk_in = 0;
  std::uint8_t interrupt_in = 0;  ///< 0: it has none
};

/// A way to one USBTMC interface: its transfers as they are on the wire, without any meaning. Each call is one
/// transfer, bounded by its timeout.
///
/// Errors of all calls: Unreachable (not there, or gone), TimedOut (nothing came or nothing was taken), IncompleteData
/// (a part came before the timeout), DeviceRefused (the endpoint stalled), BadReply (more came than there was room for,
/// or the transfer broke), WrongState (not open). Threads: owned by one.
class UsbtmcLink {
 public:
  virtual ~UsbtmcLink() = default;

  /// Finds the device and takes its USBTMC interface. Opening what is open closes it first. Errors: WrongDevice (the
  /// kind is there, with other serial numbers), ControlLost (another program has the interface).
  [[nodiscard]] virtual Result<DetectorIdentity> open() = 0;
  virtual void close() = 0;
  [[nodiscard]] virtual bool is_open() const = 0;
  /// Of the open device.
  [[nodiscard]] virtual UsbtmcInterface interface() const = 0;

  [[nodiscard]] virtual Result<void> bulk_out(std::span<const std::uint8_t> bytes, Duration timeout) = 0;
  /// One transfer: up to `most` bytes, or up to a short packet.
  [[nodiscard]] virtual Result<std::vector<std::uint8_t>> bulk_in(std::size_t most, Duration timeout) = 0;
  [[nodiscard]] virtual Result<std::vector<std::uint8_t>> interrupt_in(Duration timeout) = 0;
  [[nodiscard]] virtual Result<std::vector<std::uint8_t>> control_in(const usbtmc::ControlRequest& request,
                                                                     Duration timeout) = 0;
  /// Of one endpoint, at the host and at the device.
  [[nodiscard]] virtual Result<void> clear_halt(std::uint8_t endpoint) = 0;
};

}  // namespace gonio::drivers
