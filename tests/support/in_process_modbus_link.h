#pragma once

#include <optional>

#include "drivers/links/modbus_link.h"
#include "sim/wires/live_instrument.h"

namespace gonio::test {

/// The simulated stage's registers without a wire: each transaction happens at the instrument's own time and takes
/// none.
class InProcessModbusLink final : public drivers::ModbusLink {
 public:
  explicit InProcessModbusLink(sim::LiveInstrument& instrument) : instrument_(instrument) {}

  Result<void> read_registers(std::uint16_t first, std::span<std::uint16_t> into) override;
  Result<void> write_registers(std::uint16_t first, std::span<const std::uint16_t> words) override;
  Result<void> write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words, std::uint16_t read_first,
                              std::span<std::uint16_t> into) override;
  void resync() override {}
  void interrupt() override {}

  /// From now on every transaction fails so, as if the cable were out; nothing mends it.
  void set_broken(std::optional<Error> error) { broken_ = std::move(error); }

 private:
  sim::LiveInstrument& instrument_;
  std::optional<Error> broken_;
};

}  // namespace gonio::test
