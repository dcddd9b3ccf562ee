#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "protocol/stage/axis.h"
#include "sim/faults/fault_table.h"

namespace gonio::sim {

/// The values of a fault's parameters; those that it does not have are never asked for.
struct FaultValues {
  std::array<double, kFaultParameters> values = defaults();

  [[nodiscard]] double operator[](FaultParameter p) const { return values[static_cast<std::size_t>(p)]; }
  double& operator[](FaultParameter p) { return values[static_cast<std::size_t>(p)]; }

 private:
  [[nodiscard]] static constexpr std::array<double, kFaultParameters> defaults() {
    std::array<double, kFaultParameters> all{};
    for (const FaultParameterTraits& parameter : kFaultParameterTable)
      all[static_cast<std::size_t>(parameter.parameter)] = parameter.fallback;
    return all;
  }
};

/// One fault, and when it is to come.
struct PlannedFault {
  FaultKind kind = FaultKind::ReplyLost;
  std::optional<unsigned> after;  ///< so many of its moments pass first; none: at once where that can be, else 0
  double at_s = 0.0;              ///< not before this scene time
  unsigned times = 1;             ///< at so many of its moments, one after the other
  FaultValues values{};

  [[nodiscard]] stage::Axis axis() const;
  [[nodiscard]] ExchangeKind exchange() const;
  [[nodiscard]] FaultRole role() const;
  [[nodiscard]] double by() const { return values[FaultParameter::By]; }
  [[nodiscard]] double factor() const { return 1.0 + values[FaultParameter::ByPercent] / 100.0; }
  [[nodiscard]] std::uint8_t code() const;
  [[nodiscard]] std::uint32_t packets() const;
  [[nodiscard]] Duration late() const { return seconds(values[FaultParameter::LateWallS]); }
  /// When a fault that begins now ends; nothing: when it is told off.
  [[nodiscard]] std::optional<Instant> end(Instant now) const;
};

/// The faults of a scene.
using FaultPlan = std::vector<PlannedFault>;

/// Limits of what stands beside the parameters.
inline constexpr unsigned kMostMoments = 1'000'000;
inline constexpr double kMostSceneSeconds = 1e9;

/// What somebody wrote, by key; numbers as numbers, names as names. `device` may be left out.
struct FaultWish {
  std::string name;
  std::string device;
  std::vector<std::pair<std::string, double>> numbers;
  std::vector<std::pair<std::string, std::string>> names;
};
/// Strict: errors are InvalidInput, OutOfLimits or UnknownKey, with the key in `where->field`.
[[nodiscard]] Result<PlannedFault> planned_fault(const FaultWish& wish);

/// All faults with their parameters, for people.
[[nodiscard]] std::string fault_list();

}  // namespace gonio::sim
