#include "reflectance/light/lit_reflectance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reflectance/integral/directional_reflectance.h"
#include "tests/reflectance/light/lights.h"
#include "tests/reflectance/printed.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;

constexpr double kPi = std::numbers::pi;

Surface minnaert() {
  return surface("minnaert", {{"rho", 0.5}, {"k", 0.5}});
}

// The value within `tolerance` and, with one unit of rounding, within the error that it claims.
void expect_value(const Result<LitIntegral>& result, const Printed& expected, double tolerance) {
  ASSERT_TRUE(result) << describe(result.error());
  EXPECT_TRUE(agrees(result->value, expected, tolerance));
  EXPECT_LE(result->error, 2.0 * tolerance * std::abs(result->value));
  const double half_digit = expected.half_last_digit() * std::abs(expected.value());
  EXPECT_LE(std::abs(result->value - expected.value()), result->error + half_digit);
}

TEST(HemisphericalReflectance, IsRhoForALambertianSurfaceUnderAnyLight) {
  for (const NamedLight& named : lights()) {
    SCOPED_TRACE(named.name);

    const Result<LitIntegral> r = hemispherical_reflectance(surface("lambertian", {{"rho", 0.37}}), named.light, 1e-4);

    ASSERT_TRUE(r) << describe(r.error());
    EXPECT_NEAR(r->value, 0.37, 0.37e-12);
    EXPECT_TRUE(r->is_physical());
  }
}

TEST(HemisphericalReflectance, IsRhoDhUnderABeam) {
  const Light beam = Beam::make(Direction::from_angles(60_deg, 33_deg), 1361.0).value();

  expect_value(hemispherical_reflectance(wheat(), beam, 1e-11), "0.712386680567085", 1e-11);
  expect_value(hemispherical_reflectance(surface("fresnel_mirror", {{"refractive_index", 1.34}}), beam, 1e-11),
               "0.0610048547310245", 1e-14);
}

TEST(HemisphericalReflectance, IsTheBondAlbedoUnderAUniformSky) {
  const Light uniform = UniformSky::make(0.25).value();

  expect_value(hemispherical_reflectance(minnaert(), uniform, 1e-8), "0.32", 1e-8);
  expect_value(hemispherical_reflectance(surface("hapke", {{"omega0", 0.9}}), uniform, 1e-9), "0.460458651382695",
               1e-9);
  expect_value(hemispherical_reflectance(surface("hapke_exact", {{"omega0", 0.5}}), uniform, 1e-9),
               "0.1465443806997184", 1e-9);
  expect_value(hemispherical_reflectance(wheat(), uniform, 1e-6), "0.72465595303254", 1e-6);
  expect_value(hemispherical_reflectance(surface("fresnel_mirror", {{"refractive_index", 1.34}}), uniform, 1e-8),
               "0.067510612213279929", 1e-8);
  expect_value(
      hemispherical_reflectance(surface("water_body", {{"rho_w", 1.0}, {"refractive_index", 1.34}}), uniform, 1e-8),
      "0.932489387786720071", 1e-8);
}

TEST(HemisphericalReflectance, MatchesClosedFormsUnderAnOvercastSky) {
  const Light overcast = OvercastSky::make(2.0).value();

  // 2 rho/(k+2) (1/(k+2) + 2/(k+3))/3 over 7/18.
  expect_value(hemispherical_reflectance(minnaert(), overcast, 1e-9), "0.3330612244897959", 1e-9);
  expect_value(hemispherical_reflectance(surface("hapke", {{"omega0", 0.9}}), overcast, 1e-9), "0.45136295453945",
               1e-9);
}

TEST(DownwellingIrradiance, MatchesClosedForms) {
  const Direction low = Direction::from_angles(89.9_deg, 10_deg);

  expect_value(downwelling_irradiance(UniformSky::make(1.0).value(), 1e-12), "3.14159265358979324", 1e-12);
  expect_value(downwelling_irradiance(OvercastSky::make(1.0).value(), 1e-12), "2.44346095279206141", 1e-12);
  EXPECT_DOUBLE_EQ(downwelling_irradiance(Beam::make(low, 10.0).value())->value, 10.0 * low.mu());
}

}  // namespace
}  // namespace gonio::reflectance
