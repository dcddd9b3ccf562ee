#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace gonio::stage {

/// The axes of the stage, in the order of the wire.
enum class Axis : std::uint8_t { ThetaI, ThetaR, PhiR, PhiI, Carriage, FilterWheel };
inline constexpr std::size_t kAxisCount = 6;
inline constexpr std::array<Axis, kAxisCount> kAllAxes{Axis::ThetaI, Axis::ThetaR,   Axis::PhiR,
                                                       Axis::PhiI,   Axis::Carriage, Axis::FilterWheel};

template <class T>
using PerAxis = std::array<T, kAxisCount>;

[[nodiscard]] constexpr std::size_t index_of(Axis axis) {
  return static_cast<std::size_t>(axis);
}
/// "theta_i", as in files and messages.
[[nodiscard]] std::string_view axis_name(Axis axis);
/// "deg", "mm" or "slot": the unit of every position, speed (per s) and tolerance of this axis at the edge of the
/// program.
[[nodiscard]] std::string_view axis_unit(Axis axis);
[[nodiscard]] std::optional<Axis> axis_from_name(std::string_view name);

}  // namespace gonio::stage
