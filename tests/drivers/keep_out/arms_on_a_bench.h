#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/stage.h"
#include "drivers/stage_config.h"
#include "sim/devices/trajectory.h"

namespace gonio::drivers::test {

/// Two arms whose heads overlap in radius: they meet below about 11 deg. Every axis has its own dynamics, so that paths
/// are bent.
[[nodiscard]] inline StageConfig arms_on_a_bench() {
  StageConfig config;
  config.axes = {AxisConfig{.low = 0.0, .high = 85.0, .speed = 20.0, .acceleration = 40.0, .window = 0.01},
                 AxisConfig{.low = 0.0, .high = 85.0, .speed = 13.0, .acceleration = 60.0, .window = 0.01},
                 AxisConfig{.low = -185.0, .high = 365.0, .speed = 40.0, .acceleration = 30.0, .window = 0.01},
                 AxisConfig{.low = -185.0, .high = 365.0, .speed = 25.0, .acceleration = 90.0, .window = 0.01},
                 AxisConfig{.low = 0.0, .high = 250.0, .speed = 100.0, .acceleration = 200.0, .window = 0.05},
                 AxisConfig{.low = 1.0, .high = 4.0, .speed = 2.0, .acceleration = 8.0, .window = 0.01}};
  config.keep_out.emplace(ArmHead{millimetres(550.0), millimetres(800.0), millimetres(50.0)},
                          ArmHead{millimetres(500.0), millimetres(700.0), millimetres(45.0)}, millimetres(10.0));
  return config;
}

/// The angle between the arms by the product of their directions, on its own: good to 1e-8 rad, which is enough here.
[[nodiscard]] inline Angle angle_between_arms(const stage::PerAxis<double>& at) {
  const auto rad = [&](std::size_t a) { return at[a] * std::numbers::pi / 180.0; };
  const double cosine = std::cos(rad(0)) * std::cos(rad(1)) +
                        std::sin(rad(0)) * std::sin(rad(1)) * std::cos(rad(3)) * std::cos(rad(2)) +
                        std::sin(rad(0)) * std::sin(rad(1)) * std::sin(rad(3)) * std::sin(rad(2));
  return radians(std::acos(std::clamp(cosine, -1.0, 1.0)));
}

/// The smallest angle between the arms over so many instants of a move, by the simulator's trajectories.
[[nodiscard]] inline Angle smallest_angle(const StageConfig& config, const stage::PerAxis<double>& from,
                                          const MotionTarget& to, int instants) {
  const Instant start{};
  stage::PerAxis<sim::Trajectory> paths;
  Instant end = start;
  for (std::size_t a = 0; a < paths.size(); ++a) {
    const AxisConfig& how = config.axes[a];
    paths[a] = sim::Trajectory::move(from[a], to[a].value_or(from[a]), {how.speed, how.acceleration}, start);
    end = std::max(end, paths[a].end());
  }
  Angle smallest = radians(std::numbers::pi);
  for (int k = 0; k <= instants; ++k) {
    const Instant t = start + (end - start) * k / instants;
    stage::PerAxis<double> at{};
    for (std::size_t a = 0; a < at.size(); ++a) at[a] = paths[a].position(t);
    smallest = std::min(smallest, angle_between_arms(at));
  }
  return smallest;
}

}  // namespace gonio::drivers::test
