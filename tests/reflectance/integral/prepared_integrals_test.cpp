// PreparedReflectance of surfaces without a closed form: many integrals, so that these are run optimised.
#include <gtest/gtest.h>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/integral/prepared_reflectance.h"
#include "tests/reflectance/printed.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;

PreparedReflectance prepared(const Surface& s, double tolerance) {
  return PreparedReflectance::make(s, tolerance).value();
}

Direction at(double theta_deg) {
  return Direction::from_angles(degrees(theta_deg), 20.0_deg);
}

TEST(PreparedReflectance, ReadsTheReferenceValuesOfWheat) {
  const PreparedReflectance wheat_rho = prepared(wheat(), 1e-6);

  for (const auto& [theta, printed] : {std::pair{0.0, "0.742575513854292"},
                                       {30.0, "0.734215727909711"},
                                       {60.0, "0.712386680567085"},
                                       {80.0, "0.713447834768679"},
                                       {89.0, "0.903431333882796"}}) {
    const Integral rho = wheat_rho.rho_dh(at(theta));
    EXPECT_TRUE(agrees(rho.value, printed, 1e-6)) << theta;
    EXPECT_LE(rho.error, 1e-6) << theta;
    EXPECT_EQ(rho.evaluations, 0u) << theta;
  }
}

TEST(PreparedReflectance, ReadsTheReferenceValuesOfHapkeWithAPhaseFunction) {
  // Composite Gauss-Legendre in theta and phi, bench/reflectance/reference_values.py.
  const PreparedReflectance backward = prepared(surface("hapke_hg", {{"omega0", 0.9}, {"g", -0.3}}), 1e-9);
  EXPECT_TRUE(agrees(backward.rho_dh(at(30)).value, "0.504524815835568", 1e-9));
  EXPECT_TRUE(agrees(backward.rho_dh(at(60)).value, "0.542060480563369", 1e-9));
}

TEST(PreparedReflectance, FollowsANarrowLobeAndAGlitteringSeaToTheHorizon) {
  for (const Surface& s :
       {sea("cox_munk_smith"), surface("glint", {{"slope_variance", 1e-3}, {"refractive_index", 1.34}})}) {
    const PreparedReflectance rho = prepared(s, 1e-3);
    for (const double theta : {3.0, 47.0, 71.0, 86.5, 89.7}) {
      const double truth = rho_dh(s, at(theta), 1e-7).value;
      const Integral read = rho.rho_dh(at(theta));
      EXPECT_NEAR(read.value, truth, read.error + 1e-7 * truth) << s.model() << " at " << theta;
      EXPECT_LE(read.error, 1.001e-3 * truth) << s.model() << " at " << theta;
    }
  }
}

}  // namespace
}  // namespace gonio::reflectance
