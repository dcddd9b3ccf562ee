#include "reflectance/light/lit_reflectance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/surface/surface_sum.h"
#include "tests/reflectance/light/lights.h"
#include "tests/reflectance/light/lit_expectation.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;

Surface minnaert() {
  return surface("minnaert", {{"rho", 0.5}, {"k", 0.5}});
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

TEST(HemisphericalReflectance, MatchesIndependentValuesForWheat) {
  const Light disk = sun(60.0, 135.0);
  const Light overcast = OvercastSky::make(1.0).value();

  expect_value(hemispherical_reflectance(wheat(), overcast, 1e-7), "0.7264449959", 1e-7);
  expect_value(hemispherical_reflectance(wheat(), disk, 1e-8), "0.7123871342", 1e-8);
  expect_value(hemispherical_reflectance(wheat(), 1000.0 * disk + 50.0 * overcast, 1e-7), "0.7151476071", 1e-7);
}

TEST(HemisphericalReflectance, OfASumIsTheSumOfItsTerms) {
  const Surface mirror = surface("fresnel_mirror", {{"refractive_index", 1.34}});
  const Surface body = surface("water_body", {{"rho_w", 1.0}, {"refractive_index", 1.34}});
  const Surface all = SurfaceSum::make({{mirror, 1.0}, {body, 1.0}}).value();

  // Loss-free: everything comes back under any light.
  for (const NamedLight& named : lights()) {
    SCOPED_TRACE(named.name);
    expect_close(hemispherical_reflectance(all, named.light, 1e-6), 1.0, 1e-6);
  }
}

// f = (1 + cos 2 phi_i)/(2 pi): rho_dh = cos^2(phi_i).
struct Striped {
  [[nodiscard]] Brdf eval(const Direction& i, const Direction&) const {
    return per_steradian((1.0 + std::cos(2.0 * i.phi().si())) / (2.0 * std::numbers::pi));
  }
  [[nodiscard]] std::string_view model() const { return "striped"; }
  [[nodiscard]] Parameters parameters() const { return {}; }
  [[nodiscard]] bool is_isotropic() const { return false; }
};

TEST(HemisphericalReflectance, GoesAroundForAnAnisotropicSurface) {
  expect_close(hemispherical_reflectance(Striped{}, lopsided_sky(), 1e-6), 0.5, 1e-6);
  // A sky twice as bright at phi = 0 as at 180 deg, even in cos(phi), is 1 + cos(2 phi)/2: the mean of it times
  // cos^2(phi) is 5/8.
  const FormulaSky banded{.formula = [](const Direction& i) { return 1.0 + 0.5 * std::cos(2.0 * i.phi().si()); }};
  expect_close(hemispherical_reflectance(Striped{}, banded, 1e-6), 0.625, 1e-6);
  // A small sun at phi = 60 deg.
  expect_close(hemispherical_reflectance(Striped{}, sun(50.0, 60.0, 1e-3), 1e-6), 0.25, 1e-6);
}

TEST(DownwellingIrradiance, MatchesClosedForms) {
  const Direction low = Direction::from_angles(89.9_deg, 10_deg);

  expect_value(downwelling_irradiance(UniformSky::make(1.0).value(), 1e-12), "3.14159265358979324", 1e-12);
  expect_value(downwelling_irradiance(OvercastSky::make(1.0).value(), 1e-12), "2.44346095279206141", 1e-12);
  expect_value(downwelling_irradiance(lopsided_sky(), 1e-12), "3.14159265358979324", 1e-12);
  EXPECT_DOUBLE_EQ(downwelling_irradiance(Beam::make(low, 10.0).value())->value, 10.0 * low.mu());
}

TEST(DownwellingIrradiance, MatchesIndependentValues) {
  const Direction high = Direction::from_angles(50_deg, 20_deg);

  expect_value(downwelling_irradiance(patchy_sky(), 1e-10), "4.7218103543", 1e-10);
  expect_value(downwelling_irradiance(CieSky::make(12, high, 1.0).value(), 1e-9), "5.40530168536", 1e-9);
  expect_value(downwelling_irradiance(CieSky::make(13, Direction(), 1.0).value(), 1e-9), "0.80909950044", 1e-9);
}

TEST(DownwellingIrradiance, OfASunIsItsNormalIrradianceTimesTheCosine) {
  for (const double theta : {0.0, 0.1, 30.0, 89.5}) {
    for (const double radius : {1e-6, 0.2665, 0.4, 30.0}) {
      if (theta + radius > 90.0) continue;
      const double mu = Direction::from_angles(degrees(theta), {}).mu();
      expect_close(downwelling_irradiance(sun(theta, 12.0, radius), 1e-9), mu, 1e-14);
    }
  }
}

TEST(DownwellingIrradiance, CountsOnlyWhatHasNotSetOfASun) {
  // By strips in elevation.
  const auto at = [](double theta_deg) {
    return SunDisk::make({.theta = degrees(theta_deg), .phi = 3_deg, .radius = 0.2665_deg}, 1.0).value();
  };

  expect_value(downwelling_irradiance(at(89.9), 1e-9), "1.4039765966219e-7", 1e-9);
  expect_value(downwelling_irradiance(at(90.0), 1e-9), "6.7085800236334e-8", 1e-9);
  expect_value(downwelling_irradiance(at(90.1), 1e-9), "2.1773527073767e-8", 1e-9);
}

}  // namespace
}  // namespace gonio::reflectance
