#include "reflectance/direction/direction.h"

#include <gtest/gtest.h>

#include <limits>

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;

TEST(Direction, CarriesMuAndSineOfItsAngles) {
  const Direction d = Direction::from_angles(30.0_deg, 40.0_deg);

  EXPECT_DOUBLE_EQ(d.mu(), 0.8660254037844386);
  EXPECT_DOUBLE_EQ(d.sin_theta(), 0.5);
  EXPECT_DOUBLE_EQ(in_degrees(d.elevation()), 60.0);
  EXPECT_DOUBLE_EQ(in_degrees(d.phi()), 40.0);
}

TEST(Direction, IsTheSameFromAnglesElevationAndVector) {
  const Direction by_angles = Direction::from_angles(25.0_deg, -110.0_deg);
  const Vector v = by_angles.vector();

  const Direction by_elevation = Direction::from_elevation(65.0_deg, -110.0_deg);
  const Direction by_vector = Direction::from_vector({.x = 3.0 * v.x, .y = 3.0 * v.y, .z = 3.0 * v.z});

  EXPECT_NEAR(by_elevation.theta().si(), by_angles.theta().si(), 2e-16);
  EXPECT_NEAR(by_vector.theta().si(), by_angles.theta().si(), 2e-16);
  EXPECT_NEAR(by_vector.phi().si(), by_angles.phi().si(), 5e-16);
  EXPECT_NEAR(by_vector.mu(), by_angles.mu(), 2e-16);
}

TEST(Direction, WrapsPhiIntoOneTurn) {
  EXPECT_EQ(Direction::from_angles(30.0_deg, 360.0_deg), Direction::from_angles(30.0_deg, 0.0_deg));
  EXPECT_NEAR(in_degrees(Direction::from_angles(30.0_deg, 359.9_deg).phi()), -0.1, 1e-13);
  EXPECT_EQ(Direction::from_angles(30.0_deg, -180.0_deg), Direction::from_angles(30.0_deg, 180.0_deg));
}

TEST(Direction, HasNoAzimuthAtThePole) {
  const Direction pole = Direction::from_angles(0.0_deg, 77.0_deg);

  EXPECT_EQ(pole, Direction());
  EXPECT_EQ(Direction::from_elevation(90.0_deg, 12.0_deg), Direction());
  EXPECT_EQ(Direction::from_vector({.z = 5.0}), Direction());
  EXPECT_EQ(mirrored(pole), pole);
}

TEST(Direction, IsMirroredAcrossTheNormal) {
  const Direction i = Direction::from_angles(30.0_deg, 20.0_deg);

  const Direction m = mirrored(i);

  EXPECT_EQ(m.theta(), i.theta());
  EXPECT_NEAR(in_degrees(m.phi()), -160.0, 1e-13);
  EXPECT_NEAR(in_degrees(azimuth_difference(i, m)), 180.0, 1e-13);
  EXPECT_NEAR(in_degrees(mirrored(m).phi()), 20.0, 1e-13);
}

TEST(Direction, HasRetroAtNoDifferenceOfAzimuthAndSpecularAtAHalfTurn) {
  const Geometry retro{.theta_i = 30.0_deg, .phi_i = 170.0_deg, .theta_r = 30.0_deg, .phi_r = 170.0_deg};
  const Geometry specular{.theta_i = 30.0_deg, .phi_i = 170.0_deg, .theta_r = 30.0_deg, .phi_r = 350.0_deg};

  EXPECT_EQ(phase_angle(incident_direction(retro), reflected_direction(retro)), 0.0_deg);
  EXPECT_NEAR(in_degrees(phase_angle(incident_direction(specular), reflected_direction(specular))), 60.0, 1e-13);
  EXPECT_EQ(geometry_of(incident_direction(retro), reflected_direction(retro)), retro);
}

TEST(Direction, TakesTheShortWayAroundForADifferenceOfAzimuths) {
  const Direction a = Direction::from_angles(30.0_deg, 359.9_deg);
  const Direction b = Direction::from_angles(30.0_deg, 0.1_deg);

  EXPECT_NEAR(in_degrees(azimuth_difference(a, b)), 0.2, 1e-13);
  EXPECT_NEAR(in_degrees(azimuth_difference(b, a)), -0.2, 1e-13);
  EXPECT_EQ(azimuth_difference(Direction::from_angles(9.0_deg, 90.0_deg), Direction::from_angles(9.0_deg, -90.0_deg)),
            180.0_deg);
}

TEST(Direction, AgreesWithThePhaseAngleOfTheGeometry) {
  const Geometry g{.theta_i = 41.0_deg, .phi_i = 5.0_deg, .theta_r = 63.0_deg, .phi_r = 140.0_deg};

  const Direction i = incident_direction(g);
  const Direction r = reflected_direction(g);

  // cos xi = mu_i mu_r + sin ti sin tr cos(phi_i - phi_r), Mobley (2005) eq 1; the functions must agree with it and
  // each other.
  const double eq1 = i.mu() * r.mu() + i.sin_theta() * r.sin_theta() * std::cos((5.0_deg - 140.0_deg).si());
  EXPECT_NEAR(cos_phase(i, r), eq1, 2e-16);
  EXPECT_NEAR(std::cos(phase_angle(i, r).si()), eq1, 4e-16);
  EXPECT_NEAR(phase_angle(i, r).si(), phase_angle(g).si(), 4e-16);
}

TEST(Direction, TakesAnArmBeyondTheNormalForWhatItPointsAt) {
  const Geometry beyond{.theta_i = -0.01_deg, .phi_i = 0.0_deg, .theta_r = -30.0_deg, .phi_r = 90.0_deg};

  EXPECT_EQ(incident_direction(beyond), Direction::from_angles(0.01_deg, 180.0_deg));
  EXPECT_EQ(reflected_direction(beyond).theta(), 30.0_deg);
  EXPECT_NEAR(in_degrees(reflected_direction(beyond).phi()), -90.0, 1e-13);
}

TEST(Direction, RefusesWhatIsNotInTheUpperHemisphere) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();

  const Result<Direction> below = Direction::make(90.1_deg, 0.0_deg);

  ASSERT_FALSE(below);
  EXPECT_EQ(below.error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(below.error().seen, "theta 90.1 deg");
  EXPECT_EQ(below.error().limit, "0 to 90 deg");
  EXPECT_FALSE(Direction::make(-0.1_deg, 0.0_deg));
  EXPECT_FALSE(Direction::make(radians(nan), 0.0_deg));
  EXPECT_FALSE(Direction::make(1.0_deg, radians(nan)));
  EXPECT_FALSE(Direction::make(1.0_deg, radians(inf)));
  EXPECT_FALSE(Direction::make_from_elevation(-0.1_deg, 0.0_deg));
  EXPECT_FALSE(Direction::make_from_elevation(1.0_deg, radians(nan)));
  EXPECT_FALSE(Direction::make_from_vector({}));
  EXPECT_FALSE(Direction::make_from_vector({.x = 1.0, .z = -1e-9}));
  EXPECT_FALSE(Direction::make_from_vector({.x = nan, .z = 1.0}));
  EXPECT_FALSE(Direction::make_from_vector({.z = inf}));
}

TEST(Direction, TakesTheHorizonAndThePole) {
  EXPECT_TRUE(Direction::make(0.0_deg, 0.0_deg));
  EXPECT_TRUE(Direction::make(90.0_deg, 0.0_deg));
  EXPECT_TRUE(Direction::make_from_elevation(0.0_deg, 0.0_deg));
  EXPECT_EQ(Direction::make_from_elevation(0.0_deg, 0.0_deg)->mu(), 0.0);
  EXPECT_TRUE(Direction::make_from_vector({.x = 1.0}));
}

}  // namespace
}  // namespace gonio::reflectance
