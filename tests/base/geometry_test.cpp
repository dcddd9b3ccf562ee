#include "base/geometry.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gonio {
namespace {

using namespace literals;

Geometry geometry(double theta_i, double phi_i, double theta_r, double phi_r) {
  return {degrees(theta_i), degrees(phi_i), degrees(theta_r), degrees(phi_r)};
}

TEST(PhaseAngle, IsTheDifferenceInThePlaneOfIncidence) {
  EXPECT_NEAR(in_degrees(phase_angle(geometry(30, 0, 45, 0))), 15.0, 1e-13);
  EXPECT_NEAR(in_degrees(phase_angle(geometry(30, 0, 45, 180))), 75.0, 1e-13);
  EXPECT_NEAR(in_degrees(phase_angle(geometry(90, 0, 90, 180))), 180.0, 1e-13);
}

TEST(PhaseAngle, AgreesWithTheCosineFormulaWhereThatIsGood) {
  // cos xi = mu_i mu_r + sin t_i sin t_r cos dphi at (40, 0, 55, 70), to 16 digits.
  EXPECT_NEAR(in_degrees(phase_angle(geometry(40, 0, 55, 70))), 51.72236911301397, 1e-12);
}

TEST(PhaseAngle, KeepsItsDigitsNearRetroWhereTheCosineLosesThem) {
  constexpr double kSmall = 1e-9;
  const Geometry g{radians(0.5), radians(0.0), radians(0.5 + kSmall), radians(0.0)};

  EXPECT_NEAR(in_radians(phase_angle(g)), kSmall, 1e-15);
  const double naive = std::acos(std::cos(0.5) * std::cos(0.5 + kSmall) + std::sin(0.5) * std::sin(0.5 + kSmall));
  EXPECT_GT(std::abs(naive - kSmall), 0.5 * kSmall);
}

TEST(Wrapped, LiesAboveMinus180AndUpTo180) {
  EXPECT_NEAR(in_degrees(wrapped(359.9_deg)), -0.1, 1e-12);
  EXPECT_DOUBLE_EQ(in_degrees(wrapped(-180.0 * 1_deg)), 180.0);
  EXPECT_DOUBLE_EQ(in_degrees(wrapped(180_deg)), 180.0);
  EXPECT_NEAR(in_degrees(wrapped(720_deg)), 0.0, 1e-12);
}

TEST(SameGeometry, ForgetsAzimuthAtThePole) {
  EXPECT_TRUE(same_geometry(geometry(30, 0, 0, 0), geometry(30, 0, 0, 120), true, 0.001_deg));
  EXPECT_TRUE(same_geometry(geometry(0, 0, 40, 10), geometry(0, 0, 40, 250), true, 0.001_deg));
  EXPECT_FALSE(same_geometry(geometry(0, 0, 40, 10), geometry(0, 0, 40, 250), false, 0.001_deg));
}

TEST(SameGeometry, CountsRelativeAzimuthForAnIsotropicSample) {
  EXPECT_TRUE(same_geometry(geometry(30, 0, 40, 359.9999), geometry(30, 10, 40, 9.9999), true, 0.001_deg));
  EXPECT_FALSE(same_geometry(geometry(30, 0, 40, 0), geometry(30, 10, 40, 10), false, 0.001_deg));
  EXPECT_FALSE(same_geometry(geometry(30, 0, 40, 0), geometry(30, 0, 40, 1), true, 0.001_deg));
}

}  // namespace
}  // namespace gonio
