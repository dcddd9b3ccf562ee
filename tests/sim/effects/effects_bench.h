#pragma once

#include <numbers>

#include "sim/optics/light_path.h"
#include "tests/sim/bench.h"

namespace gonio::sim::test {

inline double in_rad(double deg) {
  return deg * std::numbers::pi / 180.0;
}

inline Geometry at_deg(double theta_i, double theta_r, double phi_r) {
  return {.theta_i = degrees(theta_i), .theta_r = degrees(theta_r), .phi_r = degrees(phi_r)};
}

/// The wheat of the notes: a hot spot, and slopes everywhere.
inline reflectance::Surface wheat() {
  return *reflectance::make_surface("rpv", {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}});
}

/// Waves of 10 m/s: a lobe.
inline reflectance::Surface sea() {
  return *reflectance::make_surface("cox_munk", {{"wind_m_per_s", 10.0}, {"refractive_index", 1.34}});
}

inline Scene scene_with(const reflectance::Surface& surface) {
  Scene scene = quiet_scene();
  scene.sample = {{.surface = surface, .weight = 1.0}};
  return scene;
}

/// The stage of the quiet scene with both shutters open, before the sample.
inline StagePose pose_at(const Geometry& g, double carriage_mm = 0.0) {
  StagePose pose{.source_open = true, .detector_open = true};
  pose.positions = {in_degrees(g.theta_i), in_degrees(g.theta_r), in_degrees(g.phi_r),
                    in_degrees(g.phi_i),   carriage_mm,           1.0};
  return pose;
}

inline constexpr double kReferenceMm = 120.0;
inline constexpr double kTrapMm = 240.0;
inline constexpr double kBetweenMm = 60.0;

/// Electrons per second from white at normal incidence, of the quiet scene.
inline constexpr double kWhite = 700000.0;

inline LightRate rate_of(const Scene& scene, const StagePose& pose) {
  const Truth truth(scene);
  return LightPath(scene, truth).rate(pose);
}
inline double target_rate(const Scene& scene, const Geometry& g, double carriage_mm = 0.0) {
  return rate_of(scene, pose_at(g, carriage_mm)).target;
}

}  // namespace gonio::sim::test
