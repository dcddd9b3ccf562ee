#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/clock.h"
#include "protocol/stage/register_map.h"
#include "sim/faults/fault_plan.h"
#include "sim/wires/live_instrument.h"

namespace gonio::sim {

/// What becomes of one request on the stage's wire.
struct ExchangeFate {
  bool is_silent = false;  ///< neither obeyed nor answered
  bool is_refused = false;
  std::optional<PlannedFault> fault;  ///< of the reply
  /// Exception and unobeyed requests need no reply of the stage's.
  [[nodiscard]] bool is(FaultKind kind) const { return fault && fault->kind == kind; }
};
/// Asks the instrument's faults. `pdu` of the request, at least 1 byte.
[[nodiscard]] ExchangeFate fate_of_exchange(LiveInstrument::Parts& parts, std::span<const std::uint8_t> pdu);

/// What a request is for, by the registers that it writes.
[[nodiscard]] ExchangeKind exchange_kind(std::span<const std::uint8_t> pdu, const stage::RegisterMap& map);

/// A reply as it goes out.
struct FaultyReply {
  std::vector<std::uint8_t> bytes;
  Duration late{};
  bool resets = false;  ///< the connections go with it
};
/// `reply` is what would go out, whole; `before` the last one of the same kind that did (Modbus TCP: MBAP and PDU).
[[nodiscard]] FaultyReply spoil_tcp(const PlannedFault& fault, std::vector<std::uint8_t> reply,
                                    std::span<const std::uint8_t> before);
/// The same on Modbus RTU: unit, PDU, CRC.
[[nodiscard]] FaultyReply spoil_rtu(const PlannedFault& fault, std::vector<std::uint8_t> reply,
                                    std::span<const std::uint8_t> before);
/// Function code with its top bit, and the code.
[[nodiscard]] std::vector<std::uint8_t> exception_pdu(std::span<const std::uint8_t> request, std::uint8_t code);

}  // namespace gonio::sim
