// L_r (eq 3) and R_rs, with the mirror part of eq 9.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reflectance/light/lit_reflectance.h"
#include "reflectance/surface/surface_sum.h"
#include "tests/reflectance/light/lights.h"
#include "tests/reflectance/light/lit_expectation.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;

const Direction kView = Direction::from_angles(40_deg, 100_deg);

Surface mirror() {
  return surface("fresnel_mirror", {{"refractive_index", 1.34}});
}

Surface water(double rho_w = 0.02) {
  return surface("water_body", {{"rho_w", rho_w}, {"refractive_index", 1.34}});
}

Surface glint(double slope_variance) {
  return surface("glint", {{"slope_variance", slope_variance}, {"refractive_index", 1.34}});
}

TEST(ReflectedRadiance, MatchesIndependentValuesUnderATable) {
  expect_value(reflected_radiance(wheat(), patchy_sky(), kView, 1e-7), "1.0917752137", 1e-7);
  expect_value(reflected_radiance(glint(0.001), patchy_sky(), kView, 1e-6), "0.0342233491344", 1e-6);
}

TEST(ReflectedRadiance, MatchesAnIndependentValueUnderAClearSky) {
  // Two hard points: the aureole and the hot spot.
  const Light clear = CieSky::make(12, Direction::from_angles(50_deg, 20_deg), 1.0).value();

  expect_value(reflected_radiance(wheat(), clear, kView, 1e-8), "1.2487249249", 1e-8);
}

TEST(ReflectedRadiance, MatchesIndependentValuesUnderASun) {
  const Light disk = sun(30.0, 0.0);

  // Broad glitter; a glint as narrow as the disk, whose mirror direction lies in it; a hot spot in the disk.
  expect_value(reflected_radiance(sea(), disk, Direction::from_angles(30.1_deg, 180_deg), 1e-9), "0.037684144439",
               1e-9);
  expect_value(reflected_radiance(glint(1e-5), disk, Direction::from_angles(30.1_deg, 180_deg), 1e-8), "143.105618104",
               1e-8);
  expect_value(reflected_radiance(wheat(), disk, Direction::from_angles(30.1_deg, 0_deg), 1e-8), "0.292985", 1e-8);
}

TEST(ReflectedRadiance, GoesOverFromADiskToABeamAsTheRadiusShrinks) {
  const Direction r = Direction::from_angles(20_deg, 80_deg);
  const Light beam = Beam::make(Direction::from_angles(30_deg, 0_deg), 1.0).value();
  const double limit = reflected_radiance(wheat(), beam, r)->value;

  EXPECT_NEAR(reflected_radiance(wheat(), sun(30.0, 0.0, 1e-3), r)->value, limit, 1e-9 * limit);
  EXPECT_NEAR(reflected_radiance(wheat(), sun(30.0, 0.0, 1e-6), r)->value, limit, 1e-13 * limit);
}

TEST(ReflectedRadiance, OfAMirrorIsFresnelsShareOfWhatItMirrors) {
  const Direction i = mirrored(kView);
  const double share = mirror().specular(i);

  for (const NamedLight& named : lights()) {
    SCOPED_TRACE(named.name);
    EXPECT_DOUBLE_EQ(reflected_radiance(mirror(), named.light, kView)->value, share * named.light.radiance_from(i));
  }
  const Light disk = sun(40.1, -80.0);
  EXPECT_GT(reflected_radiance(mirror(), disk, kView)->value, 0.0);
  EXPECT_DOUBLE_EQ(reflected_radiance(mirror(), disk, kView)->value, share * disk.radiance_from(i));
}

TEST(ReflectedRadiance, RefusesTheMirrorImageOfABeam) {
  const Light beam = Beam::make(mirrored(kView), 1.0).value();

  const Result<LitIntegral> image = reflected_radiance(mirror(), beam, kView);

  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().code, ErrorCode::InvalidInput);
  EXPECT_NE(describe(image.error()).find("theta 40 deg"), std::string::npos);
  EXPECT_EQ(reflected_radiance(mirror(), beam, Direction::from_angles(41_deg, 100_deg))->value, 0.0);
}

TEST(ReflectedRadiance, RefusesTheMirrorImageOfABeamWhateverItsAzimuthsRounding) {
  for (int k = 0; k < 360; ++k) {
    const Angle phi = degrees(0.1 + k);
    const Light beam = Beam::make(Direction::from_angles(40_deg, phi), 1.0).value();
    EXPECT_FALSE(reflected_radiance(mirror(), beam, Direction::from_angles(40_deg, phi + 180_deg))) << k;
  }
}

TEST(RemoteSensingReflectance, OfALambertianSurfaceIsRhoByPi) {
  for (const NamedLight& named : lights()) {
    SCOPED_TRACE(named.name);
    const Result<LitIntegral> r_rs =
        remote_sensing_reflectance(surface("lambertian", {{"rho", 0.37}}), named.light, kView, 1e-4);
    EXPECT_NEAR(r_rs->value, 0.37 / std::numbers::pi, 1e-13);
  }
}

TEST(RemoteSensingReflectance, OfWaterAloneLeavesOutMirrorAndGlint) {
  const Surface ocean = SurfaceSum::make({{sea(), 1.0}, {mirror(), 0.5}, {water(), 0.9}}).value();
  const Light beam = Beam::make(Direction::from_angles(30_deg, 0_deg), 1000.0).value();
  const Direction r = Direction::from_angles(45_deg, 180_deg);

  const Surface below = water_leaving_part(ocean).value();

  // 0.9 of the reference's f_w(30, 45), rho_w = .02.
  expect_value(remote_sensing_reflectance(below, beam, r), "0.00305967756728520", 1e-13);
  EXPECT_GT(remote_sensing_reflectance(ocean, beam, r)->value, 0.04);
  EXPECT_EQ(water_leaving_part(water())->model(), "water_body");
}

TEST(RemoteSensingReflectance, NeedsWaterForItsWaterLeavingPart) {
  const Result<Surface> none = water_leaving_part(wheat());

  ASSERT_FALSE(none);
  EXPECT_NE(describe(none.error()).find("rpv"), std::string::npos);
}

TEST(RemoteSensingReflectance, OfWaterUnderAUniformSkyIsItsAlbedoForTheView) {
  const Surface body = water(1.0);

  // L_r = L rho_hd, E_d = pi L, and rho_hd = T of the view for a loss-free body.
  const double passed = 1.0 - mirror().specular(kView);
  expect_close(remote_sensing_reflectance(body, UniformSky::make(3.0).value(), kView, 1e-9), passed / std::numbers::pi,
               1e-9);
}

}  // namespace
}  // namespace gonio::reflectance
