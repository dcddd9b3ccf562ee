#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "base/clock.h"

namespace gonio::sim {

/// Why a request is refused, with the numbers of the Modbus Application Protocol V1.1b3, section 7.
enum class ModbusException : std::uint8_t { IllegalFunction = 1, IllegalAddress = 2, IllegalValue = 3 };

/// A device as its registers: what a Modbus master sees, without the wire. Threads: one at a time, as the instrument.
class RegisterFace {
 public:
  virtual ~RegisterFace() = default;
  /// Reads `out.size()` registers from `first` on.
  [[nodiscard]] virtual std::optional<ModbusException> read(std::uint16_t first, std::span<std::uint16_t> out,
                                                            Instant now) = 0;
  /// Writes registers, and does what they command.
  [[nodiscard]] virtual std::optional<ModbusException> write(std::uint16_t first, std::span<const std::uint16_t> values,
                                                             Instant now) = 0;
  /// Whether it is read as input registers (FC4) and not as holding ones.
  [[nodiscard]] virtual bool has_input_registers() const { return false; }
};

/// The devices of one wire, by unit id.
class ModbusUnits {
 public:
  virtual ~ModbusUnits() = default;
  /// Null when nobody has that id.
  [[nodiscard]] virtual RegisterFace* unit(std::uint8_t id) = 0;
};

}  // namespace gonio::sim
