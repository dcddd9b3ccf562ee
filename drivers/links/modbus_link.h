#pragma once

#include <cstdint>
#include <span>

#include "base/result.h"

namespace gonio::drivers {

/// A way to the holding registers of one Modbus unit. Addresses count from 0.
///
/// Each call is one transaction, bounded by the link's reply timeout, preceded by at most one bounded attempt to
/// connect when there is no connection. After an error the next call starts on a line that holds nothing of the last.
/// Errors of all calls: Unreachable (no connection, or it broke), TimedOut (no reply within the reply timeout),
/// BadReply (not a reply to this request), DeviceRefused (an exception reply; the line stays in step).
/// Threads: owned by one, but for `interrupt`.
class ModbusLink {
 public:
  virtual ~ModbusLink() = default;

  /// FC3, at most 125 registers.
  [[nodiscard]] virtual Result<void> read_registers(std::uint16_t first, std::span<std::uint16_t> into) = 0;
  /// One register by FC6, more by FC16 (at most 123).
  [[nodiscard]] virtual Result<void> write_registers(std::uint16_t first, std::span<const std::uint16_t> words) = 0;
  /// FC23: writes (at most 121 registers), then reads (at most 125), in one transaction.
  [[nodiscard]] virtual Result<void> write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words,
                                                    std::uint16_t read_first, std::span<std::uint16_t> into) = 0;
  /// Drops whatever the line may still hold: for a reply that came in step but was not the one asked for.
  virtual void resync() = 0;
  /// Breaks the connection: a call in progress fails at once with Unreachable, and without one the next call does.
  /// Threads: any.
  virtual void interrupt() = 0;
};

}  // namespace gonio::drivers
