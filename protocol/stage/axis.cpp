#include "protocol/stage/axis.h"

#include <algorithm>

namespace gonio::stage {
namespace {

struct AxisWords {
  std::string_view name;
  std::string_view unit;
};

constexpr PerAxis<AxisWords> kWords{{{"theta_i", "deg"},
                                     {"theta_r", "deg"},
                                     {"phi_r", "deg"},
                                     {"phi_i", "deg"},
                                     {"carriage", "mm"},
                                     {"filter_wheel", "slot"}}};

}  // namespace

std::string_view axis_name(Axis axis) {
  return kWords[index_of(axis)].name;
}
std::string_view axis_unit(Axis axis) {
  return kWords[index_of(axis)].unit;
}

std::optional<Axis> axis_from_name(std::string_view name) {
  const auto found = std::ranges::find(kAllAxes, name, axis_name);
  return found == kAllAxes.end() ? std::nullopt : std::optional<Axis>(*found);
}

}  // namespace gonio::stage
