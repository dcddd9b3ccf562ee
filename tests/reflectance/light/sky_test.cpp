// The lights themselves: what they are, and what they refuse.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "reflectance/light/lit_reflectance.h"
#include "tests/reflectance/light/lights.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

template <class T>
void expect_refusal(const Result<T>& result, const std::string& part) {
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::InvalidInput);
  EXPECT_NE(describe(result.error()).find(part), std::string::npos) << describe(result.error());
}

TEST(CieSky, MatchesPublishedValues) {
  // Sun at theta 30 deg, azimuth 0; seen at theta 45 deg, azimuth 180 deg (printed by the colour-science package).
  const Direction at_sun = Direction::from_angles(30_deg, 0_deg);
  const Direction seen = Direction::from_angles(45_deg, 180_deg);

  EXPECT_NEAR(CieSky::make(1, at_sun, 1.0)->radiance(seen), 0.8325846, 5e-8);
  EXPECT_NEAR(CieSky::make(12, at_sun, 1.0)->radiance(seen), 0.4544524, 5e-8);
}

TEST(CieSky, HasItsZenithRadianceAtTheZenith) {
  const Direction at_sun = Direction::from_angles(55_deg, 10_deg);

  for (int type = 1; type <= 15; ++type) {
    EXPECT_NEAR(CieSky::make(type, at_sun, 7.0)->radiance(Direction()), 7.0, 1e-14) << type;
  }
}

TEST(CieSky, OfTypeFiveIsUniform) {
  const CieSky sky = CieSky::make(5, Direction(), 2.0).value();

  EXPECT_TRUE(sky.is_zonal());
  EXPECT_EQ(sky.radiance(Direction::from_elevation(0_deg, 0_deg)), 2.0);
}

TEST(CieSky, RefusesTypesThatDoNotExist) {
  expect_refusal(CieSky::make(0, Direction(), 1.0), "type 0");
  expect_refusal(CieSky::make(16, Direction(), 1.0), "1 to 15");
}

TEST(TableSky, IsBilinearAndClosesInPhi) {
  const std::vector<double> radiances{9, 3, 6, 1, 2, 4, 5, 7, 8};
  const TableSky sky = TableSky::make({0_deg, 40_deg, 90_deg}, {0_deg, 120_deg, 240_deg}, radiances).value();
  const auto at = [&](Angle theta, Angle phi) { return sky.radiance(Direction::from_angles(theta, phi)); };

  EXPECT_DOUBLE_EQ(at(0_deg, 77_deg), 6.0);  // the pole: the mean of its row
  EXPECT_DOUBLE_EQ(at(40_deg, 120_deg), 2.0);
  EXPECT_DOUBLE_EQ(at(40_deg, 300_deg), 2.5);  // between the last column and the first
  EXPECT_DOUBLE_EQ(at(65_deg, 60_deg), 0.25 * (1 + 2 + 5 + 7));
  EXPECT_DOUBLE_EQ(at(90_deg, -120_deg), 8.0);
}

TEST(TableSky, RingMeanIsTheMeanAround) {
  const TableSky sky = patchy_sky();
  const Direction ring = Direction::from_angles(37_deg, 0_deg);

  double sum = 0.0;
  for (int k = 0; k < 3600; ++k) sum += sky.radiance(Direction::from_angles(37_deg, degrees(0.05 + 0.1 * k)));

  EXPECT_NEAR(sky.ring_mean(ring), sum / 3600.0, 1e-12);
}

TEST(TableSky, RefusesWhatIsNoSky) {
  const std::vector<double> four(4, 1.0);
  const std::vector<double> dark{1, 1, 1, -0.5};
  const std::vector<double> blank{1, 1, kNaN, 1};

  expect_refusal(TableSky::make({0_deg, 80_deg}, {0_deg, 90_deg}, four), "from 0 to 90 deg");
  expect_refusal(TableSky::make({0_deg, 90_deg}, {0_deg, 360_deg}, four), "less than a turn");
  expect_refusal(TableSky::make({0_deg, 90_deg}, {90_deg, 0_deg}, four), "phi 2 is 0 deg");
  expect_refusal(TableSky::make({0_deg, 90_deg}, {0_deg}, four), "2 rows of 1");
  expect_refusal(TableSky::make({0_deg, 90_deg}, {0_deg, 90_deg}, dark), "radiance -0.5 in row 2, column 2");
  expect_refusal(TableSky::make({0_deg, 90_deg}, {0_deg, 90_deg}, blank), "row 2, column 1");
  expect_refusal(TableSky::make({}, {}, {}), "0 rows");
}

TEST(SunDisk, RefusesPlacesThatAreNotInTheSky) {
  expect_refusal(SunDisk::make({.theta = 91_deg, .phi = 0_deg}, 1.0), "90.2665");
  expect_refusal(SunDisk::make({.theta = 10_deg, .phi = 0_deg, .radius = 0_deg}, 1.0), "radius 0 deg");
  expect_refusal(SunDisk::make({.theta = 10_deg, .phi = radians(kNaN)}, 1.0), "phi");
  expect_refusal(SunDisk::make({.theta = radians(kNaN), .phi = 0_deg}, 1.0), "theta");
  expect_refusal(SunDisk::make({.theta = 10_deg, .phi = 0_deg}, -1.0), "radiance = -1");
  expect_refusal(SunDisk::make_from_normal_irradiance({.theta = 10_deg, .phi = 0_deg}, kNaN), "normal_irradiance");
}

TEST(SunDisk, CoversWhatLiesWithinItsRadius) {
  const SunDisk disk = sun(30.0, 359.9, 0.5);

  EXPECT_TRUE(disk.covers(Direction::from_angles(30.4_deg, 0.1_deg)));
  EXPECT_FALSE(disk.covers(Direction::from_angles(30.4_deg, 0.9_deg)));
  EXPECT_FALSE(disk.covers(Direction::from_angles(29.4_deg, -0.1_deg)));
}

TEST(Light, AddsAndScalesItsParts) {
  const Light light = sun(30.0, 0.0) + 0.25 * OvercastSky::make(4.0).value();

  EXPECT_EQ(light.parts().size(), 2U);
  EXPECT_DOUBLE_EQ(light.radiance_from(Direction::from_angles(60_deg, 0_deg)), 2.0 / 3.0);
  EXPECT_GT(light.radiance_from(Direction::from_angles(30_deg, 0_deg)), 1e4);
}

TEST(Light, RefusesBrightnessThatIsNegativeOrNotFinite) {
  expect_refusal(UniformSky::make(-1.0), "radiance = -1");
  expect_refusal(OvercastSky::make(kNaN), "zenith_radiance");
  expect_refusal(Beam::make(Direction(), -2.0), "normal_irradiance = -2");
}

TEST(Light, WhoseFormulaFailsIsRefusedWithTheDirection) {
  const FormulaSky negative{.formula = [](const Direction& i) { return i.mu() - 0.5; }};
  const FormulaSky blank{.formula = [](const Direction& i) { return i.mu() > 0.5 ? 1.0 : kNaN; }};

  for (const Light& light : {Light(negative), Light(blank)}) {
    expect_refusal(downwelling_irradiance(light), "theta ");
    expect_refusal(hemispherical_reflectance(wheat(), light), "theta ");
    expect_refusal(reflected_radiance(wheat(), light, Direction()), "theta ");
  }
  expect_refusal(downwelling_irradiance(blank), "radiance nan");
}

TEST(Light, ThatIsDarkHasNoReflectance) {
  const Light dark = UniformSky::make(0.0).value();
  const Light setting = Beam::make(Direction::from_elevation(0_deg, 0_deg), 1000.0).value();

  EXPECT_EQ(downwelling_irradiance(dark)->value, 0.0);
  EXPECT_EQ(upwelling_irradiance(wheat(), dark)->value, 0.0);
  expect_refusal(hemispherical_reflectance(wheat(), dark), "E_d = 0");
  expect_refusal(remote_sensing_reflectance(wheat(), setting, Direction()), "E_d = 0");
}

}  // namespace
}  // namespace gonio::reflectance
