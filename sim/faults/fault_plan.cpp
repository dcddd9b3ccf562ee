#include "sim/faults/fault_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace gonio::sim {
namespace {

Error refusal(ErrorCode code, const FaultWish& wish, const std::string& key, std::string seen, std::string limit) {
  return {.code = code,
          .device = "goniosim",
          .tried = fmt::format("arm the fault \"{}\"", wish.name),
          .seen = fmt::format("{}: {}", key, seen),
          .limit = std::move(limit),
          .where = InputLocation{"", 0, key}};
}

std::string joined(std::span<const std::string_view> names) {
  return fmt::format("one of {}", fmt::join(names, ", "));
}

std::string fault_names() {
  std::string text;
  for (const FaultTraits& fault : kFaultTable) text += (text.empty() ? "" : ", ") + std::string(fault.name);
  return text;
}

std::string keys_of(const FaultTraits& fault) {
  std::string text = "name, device, after, at_s, times";
  for (const FaultParameterTraits& p : kFaultParameterTable) {
    if (fault.parameters.has(p.parameter)) text += ", " + std::string(p.key);
  }
  return text;
}

const FaultParameterTraits* parameter_of(const FaultTraits& fault, std::string_view key) {
  const auto* found = std::ranges::find(kFaultParameterTable, key, &FaultParameterTraits::key);
  return found != kFaultParameterTable.end() && fault.parameters.has(found->parameter) ? found : nullptr;
}

Result<double> in_range(const FaultWish& wish, const std::string& key, double value, double least, double most,
                        bool is_whole) {
  if (value >= least && value <= most && (!is_whole || value == std::floor(value))) return value;
  return failure(refusal(ErrorCode::OutOfLimits, wish, key, fmt::format("{}", value),
                         fmt::format("{}{} to {}", is_whole ? "a whole number, " : "", least, most)));
}

Result<void> take_number(const FaultWish& wish, const std::string& key, double value, PlannedFault& fault) {
  if (key == "at_s") {
    const auto at_s = in_range(wish, key, value, 0.0, kMostSceneSeconds, false);
    if (!at_s) return failure(at_s.error());
    fault.at_s = *at_s;
    return {};
  }
  if (key == "after" || key == "times") {
    const auto count = in_range(wish, key, value, key == "times" ? 1.0 : 0.0, kMostMoments, true);
    if (!count) return failure(count.error());
    const auto whole = static_cast<unsigned>(*count);
    if (key == "times")
      fault.times = whole;
    else
      fault.after = whole;
    return {};
  }
  const FaultTraits& kind = traits(fault.kind);
  const FaultParameterTraits* parameter = parameter_of(kind, key);
  if (parameter == nullptr) return failure(refusal(ErrorCode::UnknownKey, wish, key, "not known here", keys_of(kind)));
  const bool is_name = parameter->parameter == FaultParameter::Axis ||
                       parameter->parameter == FaultParameter::Exchange || parameter->parameter == FaultParameter::Role;
  if (is_name) return failure(refusal(ErrorCode::InvalidInput, wish, key, "a number", std::string(parameter->what)));
  const bool is_count = parameter->parameter == FaultParameter::Code || parameter->parameter == FaultParameter::Packets;
  const auto taken = in_range(wish, key, value, parameter->least, parameter->most, is_count);
  if (!taken) return failure(taken.error());
  fault.values[parameter->parameter] = *taken;
  return {};
}

Result<void> take_one_of(const FaultWish& wish, const std::string& key, const std::string& value,
                         std::span<const std::string_view> names, double& taken) {
  const auto found = std::ranges::find(names, value);
  if (found == names.end())
    return failure(refusal(ErrorCode::InvalidInput, wish, key, '"' + value + '"', joined(names)));
  taken = static_cast<double>(found - names.begin());
  return {};
}

Result<void> take_name(const FaultWish& wish, const std::string& key, const std::string& value, PlannedFault& fault) {
  const FaultTraits& kind = traits(fault.kind);
  const FaultParameterTraits* parameter = parameter_of(kind, key);
  if (parameter == nullptr) return failure(refusal(ErrorCode::UnknownKey, wish, key, "not known here", keys_of(kind)));
  if (parameter->parameter == FaultParameter::Axis) {
    const auto axis = stage::axis_from_name(value);
    if (!axis) {
      return failure(refusal(ErrorCode::InvalidInput, wish, key, "there is no axis \"" + value + "\"",
                             std::string(parameter->what)));
    }
    fault.values[FaultParameter::Axis] = static_cast<double>(stage::index_of(*axis));
    return {};
  }
  if (parameter->parameter == FaultParameter::Exchange) {
    return take_one_of(wish, key, value, kExchangeNames, fault.values[FaultParameter::Exchange]);
  }
  if (parameter->parameter == FaultParameter::Role) {
    return take_one_of(wish, key, value, kFaultRoleNames, fault.values[FaultParameter::Role]);
  }
  return failure(refusal(ErrorCode::InvalidInput, wish, key, '"' + value + '"', "a number"));
}

}  // namespace

stage::Axis PlannedFault::axis() const {
  return stage::kAllAxes[static_cast<std::size_t>(values[FaultParameter::Axis])];
}

ExchangeKind PlannedFault::exchange() const {
  return static_cast<ExchangeKind>(static_cast<int>(values[FaultParameter::Exchange]));
}

FaultRole PlannedFault::role() const {
  return static_cast<FaultRole>(static_cast<int>(values[FaultParameter::Role]));
}

std::uint8_t PlannedFault::code() const {
  return static_cast<std::uint8_t>(values[FaultParameter::Code]);
}

std::uint32_t PlannedFault::packets() const {
  return static_cast<std::uint32_t>(values[FaultParameter::Packets]);
}

std::optional<Instant> PlannedFault::end(Instant now) const {
  const double lasts_s = values[FaultParameter::ForWallS];
  return lasts_s < kUntilOff ? std::optional<Instant>(now + seconds(lasts_s)) : std::nullopt;
}

Result<PlannedFault> planned_fault(const FaultWish& wish) {
  const auto kind = fault_from_name(wish.name);
  if (!kind) {
    return failure(refusal(ErrorCode::InvalidInput, wish, "name", "there is no fault \"" + wish.name + '"',
                           "one of " + fault_names()));
  }
  const std::string_view device = kFaultDeviceNames[static_cast<std::size_t>(traits(*kind).device)];
  if (!wish.device.empty() && wish.device != device) {
    return failure(refusal(ErrorCode::InvalidInput, wish, "device", '"' + wish.device + '"', std::string(device)));
  }
  PlannedFault fault{.kind = *kind};
  for (const auto& [key, value] : wish.numbers) GONIO_TRY(take_number(wish, key, value, fault));
  for (const auto& [key, value] : wish.names) GONIO_TRY(take_name(wish, key, value, fault));
  return fault;
}

std::string fault_list() {
  std::string text;
  for (const FaultTraits& fault : kFaultTable) {
    text +=
        fmt::format("{:<28} {:<10} {:<9} {}\n", fault.name, kFaultDeviceNames[static_cast<std::size_t>(fault.device)],
                    kFaultMomentNames[static_cast<std::size_t>(fault.moment)], fault.what);
    for (const FaultParameterTraits& p : kFaultParameterTable) {
      if (fault.parameters.has(p.parameter)) text += fmt::format("{:30}{}: {}\n", "", p.key, p.what);
    }
  }
  return text;
}

}  // namespace gonio::sim
