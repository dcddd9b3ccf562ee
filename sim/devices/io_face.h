#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "protocol/stage/io_map.h"
#include "sim/devices/instrument.h"
#include "sim/devices/register_bank.h"
#include "sim/devices/register_face.h"

namespace gonio::sim {

/// An input/output coupler on the bench: shutters, their end switches, the interlock's contact, the lamp monitor and
/// the sensors, at the addresses of a map. Threads: one at a time, as the instrument.
class IoFace final : public RegisterFace {
 public:
  /// `instrument` and `map` must outlive it.
  IoFace(Instrument& instrument, const stage::IoMap& map);

  std::optional<ModbusException> read(std::uint16_t first, std::span<std::uint16_t> out, Instant now) override;
  std::optional<ModbusException> write(std::uint16_t first, std::span<const std::uint16_t> values,
                                       Instant now) override;
  bool has_input_registers() const override { return map_.reads == stage::ReadFunction::Input; }

 private:
  void show(Instant now);
  void show(const std::optional<stage::IoBits>& bits, bool on);
  void show(const std::optional<stage::IoNumber>& number, double value);
  [[nodiscard]] bool is(const std::optional<stage::IoBits>& bits) const;

  Instrument& instrument_;
  const stage::IoMap& map_;
  RegisterBank bank_;
};

}  // namespace gonio::sim
