#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "sim/devices/register_face.h"

namespace gonio::sim {

/// Answers one Modbus TCP request (MBAP header and PDU, whole) from the registers of the unit it is for: FC 3 (or 4,
/// where the unit has input registers), 6, 16, 23; anything else is exception 1, an absent unit exception 11. Bad
/// counts are exception 3, absent or read-only registers exception 2 (Modbus Application Protocol V1.1b3). The frames
/// themselves are built by libmodbus. Threads: owned by one.
class ModbusReply {
 public:
  /// Errors: Internal (no socket pair).
  [[nodiscard]] static Result<ModbusReply> make();
  ModbusReply(ModbusReply&&) noexcept;
  ModbusReply& operator=(ModbusReply&&) noexcept;
  ~ModbusReply();

  /// `request` at least 8 bytes long, as its MBAP header says. Writes act before reads are answered.
  [[nodiscard]] std::vector<std::uint8_t> answer(std::span<const std::uint8_t> request, ModbusUnits& units,
                                                 Instant now);
  /// The same for a PDU, at least 1 byte, of a wire with another frame about it; the PDU of the reply.
  [[nodiscard]] std::vector<std::uint8_t> answer_pdu(std::uint8_t unit, std::span<const std::uint8_t> pdu,
                                                     ModbusUnits& units, Instant now);

 private:
  struct Impl;
  explicit ModbusReply(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace gonio::sim
