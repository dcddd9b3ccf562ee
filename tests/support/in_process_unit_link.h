#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "drivers/links/modbus_link.h"
#include "sim/wires/live_instrument.h"

namespace gonio::test {

/// One unit of the simulated stage's wire without the wire: each transaction happens at the instrument's own time and
/// takes none, but for what the script says of the next.
class InProcessUnitLink final : public drivers::ModbusLink {
 public:
  enum class Next : std::uint8_t { Obey, LoseRequest, LoseReply, OtherReply };
  struct Write {
    std::uint16_t first;
    std::vector<std::uint16_t> words;
  };

  InProcessUnitLink(sim::LiveInstrument& instrument, std::uint8_t unit) : instrument_(instrument), unit_(unit) {}

  Result<void> read_registers(std::uint16_t first, std::span<std::uint16_t> into) override;
  Result<void> write_registers(std::uint16_t first, std::span<const std::uint16_t> words) override;
  Result<void> write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words, std::uint16_t read_first,
                              std::span<std::uint16_t> into) override;
  void resync() override { ++resyncs; }
  void interrupt() override {}

  std::deque<Next> script;
  bool is_dead = false;  ///< every request is lost
  std::vector<Write> writes;
  std::function<void(const Write&)> before_write = [](const Write&) {};
  int transactions = 0;
  int resyncs = 0;

 private:
  [[nodiscard]] Next next();
  sim::LiveInstrument& instrument_;
  std::uint8_t unit_;
};

}  // namespace gonio::test
