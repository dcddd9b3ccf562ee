#pragma once

#include <cstdint>
#include <optional>

#include "sim/faults/fault_table.h"

namespace gonio::sim {

/// What can go wrong once with the radiometer's next reply. Unplugging and returning are the port's.
enum class RadiometerFault : std::uint8_t {
  Stall,            ///< Bulk-IN halts instead
  Silence,          ///< no reply comes
  TornReply,        ///< half of its bytes
  DuplicatedReply,  ///< and once more, to the next request
  StaleTag,         ///< under the tag before
  NotANumber,       ///< 9.91E37
  Overload,         ///< 9.9E37
};

/// What a fault of the table does to a reply or a sample; nothing for all others.
[[nodiscard]] constexpr std::optional<RadiometerFault> radiometer_fault_of(FaultKind kind) {
  switch (kind) {
    case FaultKind::RadiometerStall:
      return RadiometerFault::Stall;
    case FaultKind::RadiometerReplyLost:
      return RadiometerFault::Silence;
    case FaultKind::RadiometerReplyTorn:
      return RadiometerFault::TornReply;
    case FaultKind::RadiometerReplyDuplicated:
      return RadiometerFault::DuplicatedReply;
    case FaultKind::RadiometerReplyStale:
      return RadiometerFault::StaleTag;
    case FaultKind::RadiometerNotANumber:
      return RadiometerFault::NotANumber;
    case FaultKind::RadiometerOverload:
      return RadiometerFault::Overload;
    default:
      return std::nullopt;
  }
}

}  // namespace gonio::sim
