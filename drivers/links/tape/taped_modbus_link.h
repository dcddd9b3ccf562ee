#pragma once

#include "drivers/links/modbus_link.h"
#include "drivers/links/tape/tape_channel.h"

namespace gonio::drivers {

/// A Modbus link whose transactions are recorded. It changes nothing of what passes.
class TapedModbusLink final : public ModbusLink {
 public:
  /// `link` must outlive it.
  TapedModbusLink(ModbusLink& link, TapeChannel channel) : link_(link), channel_(channel) {}

  Result<void> read_registers(std::uint16_t first, std::span<std::uint16_t> into) override;
  Result<void> write_registers(std::uint16_t first, std::span<const std::uint16_t> words) override;
  Result<void> write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words, std::uint16_t read_first,
                              std::span<std::uint16_t> into) override;
  void resync() override;
  /// Not recorded: it comes from another thread, and what it did is in the outcome of the call that it ended.
  void interrupt() override { link_.interrupt(); }

 private:
  Result<void> put(TapeExchange exchange, Result<void> outcome, std::span<const std::uint16_t> read);

  ModbusLink& link_;
  TapeChannel channel_;
};

}  // namespace gonio::drivers
