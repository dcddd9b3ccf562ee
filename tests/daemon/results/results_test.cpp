#include "daemon/results/results.h"

#include <gtest/gtest.h>

#include "calibration/calibrated_scan.h"
#include "daemon/results/calibration_desk.h"

namespace gonio::daemon {
namespace {

TEST(StoredBudget, AddsSharedAndRandomAgainByTheirSquares) {
  // Pairs of component and sensitivity: 3 and 4 make 5 shared; 5 and 12 make 13.
  const BrdfRow row{.value_per_sr = 100.0, .u_random_per_sr = 12.0, .sensitivities_per_sr = {0.0, 3.0, 7.0, -4.0}};

  const StoredBudget budget = budget_of(row);

  EXPECT_DOUBLE_EQ(budget.u_shared_per_sr, 5.0);
  EXPECT_DOUBLE_EQ(budget.u_per_sr, 13.0);
  EXPECT_NEAR(budget.k, 2.0, 1e-4);  // 95.45 % of a normal distribution
  EXPECT_NEAR(budget.expanded_per_sr, 26.0, 2e-3);
}

TEST(StoredBudget, FewDegreesOfFreedomWidenTheInterval) {
  const BrdfRow row{.value_per_sr = 1.0, .u_random_per_sr = 1.0, .effective_dof = 10.0};

  EXPECT_NEAR(budget_of(row).k, 2.28, 0.005);  // JCGM 100:2008, table G.2, p = 95.45 %, nu = 10
}

TEST(StoredBudget, HasTheIntervalThatItsRowStatesInsteadOfOneOfItsTerms) {
  const BrdfRow row{.value_per_sr = 1.0,
                    .u_random_per_sr = 0.1,
                    .interval = StoredInterval{.u_per_sr = 0.2, .below_per_sr = 0.3, .above_per_sr = 0.5}};

  const StoredBudget budget = budget_of(row);

  EXPECT_EQ(budget.u_per_sr, 0.2);
  EXPECT_EQ(budget.below_per_sr, 0.3);
  EXPECT_EQ(budget.above_per_sr, 0.5);
  EXPECT_EQ(budget.expanded_per_sr, 0.5);
  EXPECT_DOUBLE_EQ(budget.k, 2.5);
}

TEST(RelativeUncertainty, LeavesOutWhatIsNotToldFromZero) {
  BrdfInfo brdf;
  const auto near_zero = static_cast<std::uint32_t>(calibration::PointFlag::NearZero);
  for (const double u : {1.0, 2.0, 3.0}) brdf.rows.push_back({.value_per_sr = 100.0, .u_random_per_sr = u});
  brdf.rows.push_back({.value_per_sr = 0.001, .u_random_per_sr = 1.0, .flags = near_zero});

  const RelativeUncertainty u = relative_uncertainty(brdf);

  EXPECT_EQ(u.values, 4);
  EXPECT_NEAR(u.median.value(), 0.04, 1e-5);
  EXPECT_NEAR(u.worst.value(), 0.06, 1e-5);
}

TEST(RelativeUncertainty, OfNothingIsNothing) {
  EXPECT_FALSE(relative_uncertainty({}).median.has_value());
}

}  // namespace
}  // namespace gonio::daemon
