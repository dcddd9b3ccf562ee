#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "base/clock.h"
#include "drivers/links/modbus_link.h"
#include "drivers/links/modbus_unit.h"

namespace gonio::drivers {

struct TcpModbusConfig {
  std::string address;  ///< IPv4, in digits
  std::uint16_t port = 502;
  std::uint8_t unit_id = 1;
  Duration reply_timeout{};  ///< of one transaction, from its first byte sent to its last byte received
  Duration connect_timeout{};
};

/// Modbus TCP by libmodbus. Connects on the first call; after any error but an exception reply the connection is closed
/// and the next call makes a new one: on a reused one, replies of the past would arrive one call late for ever.
/// libmodbus' own recovery stays off: its LINK mode sends for ever when the server has gone.
class TcpModbusLink final : public ModbusLink {
 public:
  explicit TcpModbusLink(TcpModbusConfig config);
  ~TcpModbusLink() override;

  Result<void> read_registers(std::uint16_t first, std::span<std::uint16_t> into) override;
  Result<void> write_registers(std::uint16_t first, std::span<const std::uint16_t> words) override;
  Result<void> write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words, std::uint16_t read_first,
                              std::span<std::uint16_t> into) override;
  void resync() override;
  void interrupt() override;

  /// A way to another unit over the same connection, as a gateway or a line of drives behind one has them: for the
  /// thread that owns this link, which must outlive it. `resync` and `interrupt` are those of the connection.
  [[nodiscard]] std::unique_ptr<ModbusLink> for_unit(const ModbusUnit& unit);

 private:
  class Face;
  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::unique_ptr<ModbusLink> own_;  ///< the configuration's unit
};

}  // namespace gonio::drivers
