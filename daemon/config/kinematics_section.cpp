#include "daemon/config/kinematics_section.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <set>
#include <string>
#include <string_view>

#include "drivers/kinematics/turning_sample.h"

namespace gonio::daemon {
namespace {

using stage::Axis;

constexpr NumberRange kAzimuth{.least = -180.0, .most = 180.0, .unit = "deg"};
constexpr NumberRange kElevation{.least = -80.0, .most = 80.0, .unit = "deg"};
constexpr double kMostOutOfPlane_deg = 80.0;  // beyond, the arm turns about the beam and reaches next to nothing

Axis read_axis_name(TomlReader& table, std::string_view key, std::set<Axis>& taken) {
  static constexpr std::array<std::string_view, 4> kNames{"theta_i", "theta_r", "phi_r", "phi_i"};
  const std::size_t chosen = table.choice(key, kNames);
  const Axis axis = stage::axis_from_name(kNames[chosen]).value_or(Axis::ThetaI);
  if (!taken.insert(axis).second) {
    table.fail(key, ErrorCode::InvalidInput, fmt::format("{} turns something else already", kNames[chosen]),
               "one axis for each of yaw, pitch, roll and detector_arm");
  }
  return axis;
}

drivers::TurningSample read_turning_sample(TomlReader& table) {
  std::set<Axis> taken;
  drivers::TurningSample sample;
  sample.yaw = read_axis_name(table, "yaw", taken);
  sample.pitch = read_axis_name(table, "pitch", taken);
  sample.roll = read_axis_name(table, "roll", taken);
  sample.detector_arm = read_axis_name(table, "detector_arm", taken);
  sample.source_azimuth = degrees(table.number_or("source_azimuth_deg", 0.0, kAzimuth));
  sample.source_elevation = degrees(table.number_or("source_elevation_deg", 0.0, kElevation));
  sample.detector_plane_tilt = degrees(table.number_or("detector_plane_tilt_deg", 0.0, kAzimuth));
  const double e = in_degrees(sample.source_elevation);
  const double out_of_plane = in_degrees(drivers::source_out_of_plane(sample));
  if (std::abs(out_of_plane) > kMostOutOfPlane_deg) {
    table.fail("source_elevation_deg", ErrorCode::InvalidInput,
               fmt::format("{:g} deg, {:.3f} deg outside of the plane of the detector's arm", e, out_of_plane),
               fmt::format("at most {:g} deg outside of it", kMostOutOfPlane_deg));
  }
  return sample;
}

}  // namespace

void read_kinematics(TomlReader& stage_table, drivers::StageConfig& stage) {
  static constexpr std::array<std::string_view, 2> kKinds{"arms", "turning-sample"};  // as drivers::KinematicsKind
  auto table = stage_table.optional_table("kinematics");
  if (!table) return;
  stage.kinematics.kind = static_cast<drivers::KinematicsKind>(table->choice("kind", kKinds));
  if (stage.kinematics.kind == drivers::KinematicsKind::TurningSample) {
    stage.kinematics.turning = read_turning_sample(*table);
  }
}

}  // namespace gonio::daemon
