#include "sim/scene/read_kinematics.h"

#include <array>
#include <string_view>

namespace gonio::sim {
namespace {

using stage::Axis;

Axis read_axis_name(TomlReader& table, std::string_view key) {
  static constexpr std::array<std::string_view, 4> kNames{"theta_i", "theta_r", "phi_r", "phi_i"};
  return stage::axis_from_name(kNames[table.choice(key, kNames)]).value_or(Axis::ThetaI);
}

}  // namespace

void read_kinematics(TomlReader table, StageSpec& stage) {
  static constexpr std::array<std::string_view, 2> kKinds{"arms", "turning-sample"};
  if (kKinds[table.choice("kind", kKinds)] == "arms") return;
  const NumberRange turn{.least = -180.0, .most = 180.0, .unit = "deg"};
  TurningSampleSpec sample;
  sample.yaw = read_axis_name(table, "yaw");
  sample.pitch = read_axis_name(table, "pitch");
  sample.roll = read_axis_name(table, "roll");
  sample.detector_arm = read_axis_name(table, "detector_arm");
  sample.source_azimuth = degrees(table.number_or("source_azimuth_deg", 0.0, turn));
  sample.source_elevation = degrees(table.number_or("source_elevation_deg", 0.0, turn));
  sample.detector_plane_tilt = degrees(table.number_or("detector_plane_tilt_deg", 0.0, turn));
  stage.turning_sample = sample;
}

}  // namespace gonio::sim
