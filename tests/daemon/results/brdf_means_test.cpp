#include "daemon/results/brdf_means.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace gonio::daemon {
namespace {

using std::numbers::pi;

// Three points of REFF 0.9, 1.1 and 0.5: a certificate that all share, and a dark that the first two share.
NewBrdf three_points() {
  NewBrdf brdf;
  brdf.component_names = {"certificate [shared, u in 1]", "dark visit 4 [shared, u in DN]"};
  brdf.rows = {{.point = 0,
                .value_per_sr = 0.9 / pi,
                .u_random_per_sr = 0.03 / pi,
                .sensitivities_per_sr = {0, 0.009 / pi, 1, 0.004 / pi}},
               {.point = 1,
                .value_per_sr = 1.1 / pi,
                .u_random_per_sr = 0.04 / pi,
                .sensitivities_per_sr = {0, 0.011 / pi, 1, -0.004 / pi}},
               {.point = 2, .value_per_sr = 0.5 / pi, .u_random_per_sr = 0.0, .sensitivities_per_sr = {0, 0.005 / pi}}};
  return brdf;
}

TEST(BrdfMeans, OfAGroupKeepWhatItsPointsShareAndAverageTheRest) {
  const BrdfMeans means = means_of(three_points(), {{0, 1}});

  ASSERT_EQ(means.values.size(), 1U);
  EXPECT_NEAR(means.values[0], 1.0, 1e-12);
  // The dark cancels; the certificate stays at 1 %; 0.03 and 0.04 in quadrature are 0.05, halved.
  EXPECT_NEAR(std::sqrt(means.covariance[0]), std::hypot(0.010, 0.025), 1e-12);
  EXPECT_NEAR(means.u_own[0], 0.025, 1e-12) << "the certificate is no run's own";
}

TEST(BrdfMeans, LetNothingCancelWhoseSignsAreNotKnown) {
  NewBrdf brdf = three_points();
  brdf.sizes_only = {1};

  EXPECT_NEAR(means_of(brdf, {{0, 1}}).u_own[0], std::hypot(0.025, 0.004), 1e-12);
}

TEST(BrdfMeans, OfTwoGroupsGoTogetherByWhatBothShare) {
  const BrdfMeans means = means_of(three_points(), {{0}, {2}});

  ASSERT_EQ(means.covariance.size(), 4U);
  EXPECT_NEAR(means.covariance[1], 0.009 * 0.005, 1e-15);
  EXPECT_EQ(means.covariance[1], means.covariance[2]);
  EXPECT_NEAR(means.covariance[3], 0.005 * 0.005, 1e-15);
  EXPECT_NEAR(means.u_own[0], std::hypot(0.03, 0.004), 1e-12) << "a dark visit is";
}

}  // namespace
}  // namespace gonio::daemon
