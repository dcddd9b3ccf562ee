#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "drivers/links/modbus_unit.h"
#include "drivers/links/serial_line.h"

namespace gonio::drivers {

/// libmodbus, for the links of this folder: the only file of this room that knows it is behind this header.
///
/// Its own recovery stays off. Errors carry code and `seen` only; the link adds the device and what was tried.
/// DeviceRefused is an exception reply: the line stays in step. Threads: owned by one.
class ModbusContext {
 public:
  /// For whole transactions over a socket that somebody else has connected.
  [[nodiscard]] static ModbusContext tcp(std::uint8_t unit_id, Duration reply_timeout);
  /// For single frames on a serial line; `open_line` comes first.
  [[nodiscard]] static ModbusContext rtu(const SerialLine& line, std::uint8_t unit_id);
  ModbusContext(ModbusContext&&) noexcept;
  ModbusContext& operator=(ModbusContext&&) noexcept;
  ~ModbusContext();

  void use_socket(int descriptor);
  /// The transactions below are with this unit from now on, by its functions.
  void select(const ModbusUnit& unit);
  /// Errors: TimedOut, BadReply, DeviceRefused, Unreachable.
  [[nodiscard]] Result<void> read_registers(std::uint16_t first, std::span<std::uint16_t> into);
  [[nodiscard]] Result<void> write_registers(std::uint16_t first, std::span<const std::uint16_t> words);
  [[nodiscard]] Result<void> write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words,
                                            std::uint16_t read_first, std::span<std::uint16_t> into);

  /// Opens the line and sets it up; its descriptor, which stays this object's. Errors: Unreachable (also a descriptor
  /// that select cannot hold).
  [[nodiscard]] Result<int> open_line();
  void close_line();
  /// Writes a frame: unit and PDU as given, then their CRC. Errors: Unreachable.
  [[nodiscard]] Result<void> send(std::span<const std::uint8_t> unit_and_pdu);
  /// Reads a frame that has arrived already, and checks its CRC; unit and PDU. Errors: TimedOut (it is not whole),
  /// BadReply (CRC, another unit, no reply at all), Unreachable.
  [[nodiscard]] Result<std::vector<std::uint8_t>> receive();

 private:
  struct Impl;
  explicit ModbusContext(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace gonio::drivers
