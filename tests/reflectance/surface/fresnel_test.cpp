#include "reflectance/surface/fresnel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/reflectance/printed.h"

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;

struct Row {
  double theta_deg;
  Printed share;
};

TEST(Fresnel, MatchesTheReferenceFromAirIntoWater) {
  const Row rows[] = {{0, "0.0211118416246621375"}, {10, "0.0211225689326621"},
                      {30, "0.0221985233115213"},   {60, "0.0610048547310245"},
                      {80, "0.350199891892222"},    {89, "0.896796119274326"},
                      {89.9, "0.989123970555733"},  {53.2671733355106, "0.0404957540026567"}};
  for (const Row& row : rows) {
    EXPECT_TRUE(agrees(fresnel(degrees(row.theta_deg), 1.34).unpolarised(), row.share, 1e-14)) << row.theta_deg;
  }
}

TEST(Fresnel, MatchesTheReferenceFromWaterIntoAir) {
  // Condition numbers: towards the critical angle a change of theta by one bit moves R by ever more.
  const Row rows[] = {{0, "0.0211118416246621375"},
                      {30, "0.0265342535668304"},
                      {40, "0.0588126152106158"},
                      {48, "0.570532971944835"},
                      {48.26, "0.905144821649315"}};
  const double conditions[] = {1, 1, 10, 100, 300};
  for (std::size_t k = 0; k < std::size(rows); ++k) {
    const double computed = fresnel(degrees(rows[k].theta_deg), 1.0 / 1.34).unpolarised();
    EXPECT_TRUE(agrees(computed, rows[k].share, std::max(1e-14, 4.0 * conditions[k] * 0x1p-53))) << rows[k].theta_deg;
  }
}

TEST(Fresnel, ReflectsAllFromTheCriticalAngleOn) {
  const double n = 1.0 / 1.34;
  const double critical = std::asin(n);  // 48.2681829602062 deg
  EXPECT_NEAR(in_degrees(radians(critical)), 48.2681829602062, 1e-12);

  for (const double theta : {critical, std::nextafter(critical, 2.0), critical + 1e-9, 1.0, 0.5 * std::numbers::pi}) {
    EXPECT_EQ(fresnel(radians(theta), n).s, 1.0) << theta;
    EXPECT_EQ(fresnel(radians(theta), n).p, 1.0) << theta;
  }
}

TEST(Fresnel, LosesNoDigitsJustBeforeTheCriticalAngle) {
  // To first order in t = cos of the refracted angle: R_s = 1 - 4 n t / c, R_p = 1 - 4 t / (n c).
  const double n = 1.0 / 1.34;
  const double before = std::asin(n) - 1e-12;
  const double gap = std::asin(n) - before;  // what the doubles hold of 1e-12
  const double t = std::sqrt(std::sin(gap) * std::sin(2.0 * std::asin(n))) / n;
  const double c = std::cos(before);

  const FresnelReflectance share = fresnel(radians(before), n);

  EXPECT_NEAR((1.0 - share.s) / (4.0 * n * t / c), 1.0, 8.0 * t);
  EXPECT_NEAR((1.0 - share.p) / (4.0 * t / (n * c)), 1.0, 8.0 * t);
}

TEST(Fresnel, LetsThePolarisationInThePlaneThroughAtBrewstersAngle) {
  EXPECT_LT(fresnel(53.2671733355106_deg, 1.34).p, 1e-29);
  EXPECT_LT(fresnel(36.7328266644894_deg, 1.0 / 1.34).p, 1e-28);
  EXPECT_TRUE(agrees(fresnel(36.7328266644894_deg, 1.0 / 1.34).unpolarised(), "0.0404957540026567", 1e-14));
}

TEST(Fresnel, TellsTheSameFromCosinesAsFromTheAngle) {
  for (const double theta : {0.0, 0.3, 0.7, 1.2, 1.5}) {
    for (const double n : {1.0, 1.34, 1.0 / 1.34, 2.4}) {
      const FresnelReflectance by_angle = fresnel(radians(theta), n);
      const FresnelReflectance by_cosine = fresnel(std::cos(theta), std::sin(theta), n);
      EXPECT_NEAR(by_angle.s, by_cosine.s, 1e-14);
      EXPECT_NEAR(by_angle.p, by_cosine.p, 1e-14);
    }
  }
}

TEST(Fresnel, IsNothingWithoutAContrastAndKeepsItsDigitsWithAFaintOne) {
  EXPECT_EQ(fresnel(40.0_deg, 1.0).unpolarised(), 0.0);
  // ((n - 1)/(n + 1))^2 at normal incidence; n - 1 = 2^-30 is exact.
  const double faint = 0x1p-30;
  EXPECT_DOUBLE_EQ(fresnel(0.0_deg, 1.0 + faint).unpolarised(), (faint / (2.0 + faint)) * (faint / (2.0 + faint)));
}

TEST(Fresnel, PassesWhatItDoesNotReflect) {
  for (const double theta : {0.0, 0.3, 0.7, 1.2, 1.5}) {
    for (const double n : {1.0, 1.34, 1.0 / 1.34, 2.4}) {
      const double reflected = fresnel(std::cos(theta), std::sin(theta), n).unpolarised();
      EXPECT_NEAR(fresnel_transmittance(std::cos(theta), std::sin(theta), n), 1.0 - reflected, 1e-15);
    }
  }
  // Close to the horizon T = 2 c (n^2 + 1) / sqrt(n^2 - 1), where 1 - R has nothing left.
  const double c = 1e-18;
  const double n = 1.34;
  EXPECT_NEAR(fresnel_transmittance(c, 1.0, n) / (2.0 * c * (n * n + 1.0) / std::sqrt(n * n - 1.0)), 1.0, 1e-15);
}

TEST(Fresnel, MatchesTheReferenceForLightFromEverywhere) {
  EXPECT_TRUE(agrees(fresnel_albedo(1.34), "0.067510612213279929", 1e-15));
  EXPECT_TRUE(agrees(fresnel_albedo(1.0 / 1.34), "0.480680893413499626", 1e-15));
  EXPECT_TRUE(agrees(fresnel_albedo(1.33), "0.0659308492994054", 1e-15));
  EXPECT_TRUE(agrees(fresnel_albedo(1.5), "0.0917779593423512", 1e-15));
  EXPECT_TRUE(agrees(fresnel_albedo(1.0001), "0.000033291731246212696", 1e-12));
  EXPECT_NEAR(fresnel_albedo(1.0), 0.0, 1e-15);
}

}  // namespace
}  // namespace gonio::reflectance
