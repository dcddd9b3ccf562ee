#include "sim/optics/mounting.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effects_bench.h"

namespace gonio::sim::test {
namespace {

constexpr double kNearly = 1e-12;
const Length kSource = millimetres(600.0);
const Length kDetector = millimetres(500.0);

MountedView leaning(double lean_0_deg, double lean_90_deg, const Geometry& g) {
  return view_on({.lean_0 = degrees(lean_0_deg), .lean_90 = degrees(lean_90_deg)}, kSource, kDetector, g);
}

TEST(Mounting, LeavesDirectionsAloneWhenNothingLeans) {
  const MountedView view = leaning(0.0, 0.0, at_deg(30, 60, 120));

  EXPECT_NEAR(in_degrees(view.geometry.theta_i), 30.0, kNearly);
  EXPECT_NEAR(in_degrees(view.geometry.theta_r), 60.0, kNearly);
  EXPECT_NEAR(in_degrees(view.geometry.phi_r), 120.0, kNearly);
  EXPECT_NEAR(view.source_near, 1.0, kNearly);
}

TEST(Mounting, AddsAndTakesALeanInThePlaneOfIncidence) {
  const MountedView view = leaning(2.0, 0.0, at_deg(30, 60, 180));

  EXPECT_NEAR(in_degrees(view.geometry.theta_i), 28.0, kNearly);
  EXPECT_NEAR(in_degrees(view.geometry.theta_r), 62.0, kNearly);
  EXPECT_NEAR(std::abs(in_degrees(view.geometry.phi_r)), 180.0, kNearly);
}

TEST(Mounting, TurnsThePoleOverWhenTheLeanPassesTheLamp) {
  const MountedView view = leaning(3.0, 0.0, at_deg(1.0, 10, 180));

  EXPECT_NEAR(in_degrees(view.geometry.theta_i), 2.0, kNearly);
  EXPECT_NEAR(std::abs(in_degrees(view.geometry.phi_i)), 180.0, kNearly);
}

TEST(Mounting, HasTheCosinesToTheLeaningNormalAndKeepsThePhaseAngle) {
  // Normal and cosines written down as vectors; between the two directions nothing turns.
  const double lean = in_rad(std::hypot(1.5, 2.5));
  const double towards = std::atan2(2.5, 1.5);
  const double n[3] = {std::sin(lean) * std::cos(towards), std::sin(lean) * std::sin(towards), std::cos(lean)};
  const Geometry g = at_deg(50, 65, 110);
  const double i[3] = {std::sin(in_rad(50)), 0.0, std::cos(in_rad(50))};
  const double r[3] = {std::sin(in_rad(65)) * std::cos(in_rad(110)), std::sin(in_rad(65)) * std::sin(in_rad(110)),
                       std::cos(in_rad(65))};

  const Geometry seen = leaning(1.5, 2.5, g).geometry;

  EXPECT_NEAR(std::cos(seen.theta_i.si()), n[0] * i[0] + n[1] * i[1] + n[2] * i[2], 1e-14);
  EXPECT_NEAR(std::cos(seen.theta_r.si()), n[0] * r[0] + n[1] * r[1] + n[2] * r[2], 1e-14);
  EXPECT_NEAR(phase_angle(seen).si(), phase_angle(g).si(), 1e-14);
  // mpmath, 30 digits: the axes of the surface are the bench's, turned about (-2.5, 1.5, 0) by the lean.
  EXPECT_NEAR(in_degrees(seen.phi_i), -2.177087422982932, 1e-12);
  EXPECT_NEAR(in_degrees(seen.phi_r), 111.1088154557866, 1e-12);
}

TEST(Mounting, SeesTheLampFromWhereTheDetectorMeetsARaisedSurface) {
  // In the plane: the detector's axis (60 deg, on the other side) meets the plane z = h at x = -h tan 60.
  const double h = 3.0;
  const MountedView view = view_on({.height = millimetres(h)}, kSource, kDetector, at_deg(40, 60, 180));

  const double x = 600.0 * std::sin(in_rad(40)) + h * std::tan(in_rad(60));
  const double z = 600.0 * std::cos(in_rad(40)) - h;
  EXPECT_NEAR(in_degrees(view.geometry.theta_i), std::atan2(x, z) * 180.0 / std::numbers::pi, kNearly);
  EXPECT_NEAR(in_degrees(view.geometry.theta_r), 60.0, kNearly);
  EXPECT_NEAR(view.source_near, 600.0 / std::hypot(x, z), 1e-14);
  EXPECT_NEAR(view.detector_near, 500.0 / (500.0 - h / std::cos(in_rad(60))), 1e-14);
  EXPECT_NEAR(in_millimetres(view.field.x), -h * std::tan(in_rad(60)), kNearly);
  EXPECT_NEAR(in_millimetres(view.spot.x), h * std::tan(in_rad(40)), kNearly);
}

TEST(MountingInALightPath, ChangesTheCosineOfItsOwnTargetOnly) {
  Scene scene = quiet_scene();
  scene.effects.mounting = MountingSpec{.sample = {.lean_0 = degrees(1.0)}};
  const Geometry g = at_deg(60, 20, 180);

  const double sample = target_rate(scene, g) / target_rate(quiet_scene(), g);
  const double reference = target_rate(scene, g, kReferenceMm) / target_rate(quiet_scene(), g, kReferenceMm);

  // tan(theta) times the lean, to first order; a Lambertian feels nothing but the cosine.
  EXPECT_NEAR(sample, std::cos(in_rad(59.0)) / std::cos(in_rad(60.0)), kNearly);
  EXPECT_NEAR(reference, 1.0, kNearly);
}

TEST(MountingInALightPath, ComesNearerTheLampByTheInverseSquare) {
  Scene scene = quiet_scene();
  scene.effects.mounting = MountingSpec{.sample = {.height = millimetres(6.0)}};

  const double factor = target_rate(scene, at_deg(0, 0, 0)) / target_rate(quiet_scene(), at_deg(0, 0, 0));

  EXPECT_NEAR(factor, std::pow(600.0 / 594.0, 2), kNearly);
}

TEST(MountingInALightPath, ShiftsTheSpotOutOfTheField) {
  Scene scene = quiet_scene();
  scene.effects.mounting = MountingSpec{.sample = {.height = millimetres(5.0)}};
  scene.effects.overlap = OverlapSpec{.spot_radius = millimetres(5.0), .field_radius = millimetres(4.0)};
  Scene level = scene;
  level.effects.mounting->sample.height = {};

  const Geometry g = at_deg(60, 60, 180);

  // 5 mm up, the two axes meet the surface 2 x 5 tan 60 = 17.3 mm apart; the ellipses are 10 and 8 mm long.
  EXPECT_LT(target_rate(scene, g), 0.1 * target_rate(level, g));
}

TEST(MountingInALightPath, TakesTheLightOfALampBelowTheLeaningHorizon) {
  Scene scene = quiet_scene();
  scene.effects.mounting = MountingSpec{.sample = {.lean_0 = degrees(-8.0)}};

  EXPECT_EQ(target_rate(scene, at_deg(83, 0, 0)), 0.0);
}

}  // namespace
}  // namespace gonio::sim::test
