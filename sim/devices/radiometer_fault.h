#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

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

struct NamedRadiometerFault {
  std::string_view name;
  RadiometerFault fault;
};
/// As scenes and control ports say them.
inline constexpr std::array<NamedRadiometerFault, 7> kRadiometerFaults{
    {{"stall", RadiometerFault::Stall},
     {"silence", RadiometerFault::Silence},
     {"torn-reply", RadiometerFault::TornReply},
     {"duplicated-reply", RadiometerFault::DuplicatedReply},
     {"stale-tag", RadiometerFault::StaleTag},
     {"not-a-number", RadiometerFault::NotANumber},
     {"overload", RadiometerFault::Overload}}};

[[nodiscard]] constexpr std::optional<RadiometerFault> radiometer_fault_from_name(std::string_view name) {
  for (const NamedRadiometerFault& named : kRadiometerFaults) {
    if (named.name == name) return named.fault;
  }
  return std::nullopt;
}

}  // namespace gonio::sim
