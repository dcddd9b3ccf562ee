// The harness itself, in every build: what it counts, what it finds out, and that threads change nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sim/scene/chance.h"
#include "tests/coverage/budget_monte_carlo.h"
#include "tests/coverage/campaign.h"

namespace gonio::coverage {
namespace {

constexpr std::uint64_t kSeed = 4711;
constexpr int kMany = 4000;

// One shared and one random error of 1 each; u as stated, `true_u` times smaller than the truth.
std::vector<RepetitionOutcome> drawn(double true_u, std::size_t refused = 0) {
  std::vector<RepetitionOutcome> outcomes;
  sim::Chance chance(kSeed, sim::Purpose::Pixels);
  for (int n = 0; n < kMany; ++n) {
    RepetitionOutcome& outcome = outcomes.emplace_back();
    const double shared = chance.normal();
    for (std::int32_t point = 0; point < 8; ++point) {
      const double error = true_u * (shared + chance.normal());
      const double u = std::sqrt(2.0);
      outcome.points.push_back({.point = point,
                                .error = error,
                                .u = u,
                                .expanded = 2.0 * u,
                                .below = 2.0 * u,
                                .above = 2.0 * u,
                                .value = 100.0,
                                .strata = 1});
    }
    outcome.rho = outcome.points;
    outcome.refused.assign(refused, ErrorCode::Saturated);
    outcome.planned = 8 + refused;
  }
  return outcomes;
}

TEST(CoverageHarness, FindsNothingWrongWithATrueUncertainty) {
  SCOPED_TRACE(kSeed);

  const CoverageFigures figures = figures_of(drawn(1.0));

  EXPECT_NEAR(figures.held.value, 0.9545, 4.0 * figures.held.standard_error);
  // Half of the variance is shared: fewer trials than points, more than repetitions.
  EXPECT_GT(figures.held.standard_error, std::sqrt(0.9545 * 0.0455 / (8.0 * kMany)));
  EXPECT_LT(figures.held.standard_error, std::sqrt(0.9545 * 0.0455 / kMany));
  EXPECT_TRUE(failures(figures, Claim{}).empty());
}

TEST(CoverageHarness, FindsAnUncertaintyThatIsTooSmallAndOneThatIsTooLarge) {
  SCOPED_TRACE(kSeed);

  EXPECT_FALSE(failures(figures_of(drawn(1.2)), Claim{}).empty());
  EXPECT_FALSE(failures(figures_of(drawn(0.7)), Claim{}).empty());
  EXPECT_GT(figures_of(drawn(0.7)).width, 1.3);
}

TEST(CoverageHarness, FindsPointsThatAreRefused) {
  const std::vector<std::string> found = failures(figures_of(drawn(1.0, 1)), Claim{});

  ASSERT_EQ(found.size(), 1U);
  EXPECT_NE(found.front().find("refused"), std::string::npos);
}

TEST(CoverageHarness, HasTheSameOutcomesOnAnyNumberOfThreads) {
  CoverageScene scene = coverage_scenes().front();
  scene.plan.theta_r_deg = {15.0, 45.0};
  const auto prepared = prepare(scene);
  ASSERT_TRUE(prepared) << describe(prepared.error());

  const auto one = run_campaign(*prepared, {.repetitions = 5, .threads = 1});
  const auto three = run_campaign(*prepared, {.repetitions = 5, .threads = 3});

  ASSERT_TRUE(one && three);
  for (std::size_t n = 0; n < one->size(); ++n) {
    ASSERT_EQ((*one)[n].points.size(), prepared->points.size());
    for (std::size_t p = 0; p < prepared->points.size(); ++p) {
      EXPECT_EQ((*one)[n].points[p].error, (*three)[n].points[p].error);
      EXPECT_EQ((*one)[n].points[p].u, (*three)[n].points[p].u);
    }
  }
  EXPECT_NE((*one)[0].points[0].error, (*one)[1].points[0].error);
}

TEST(CoverageHarness, DrawsTheSameBudgetOnAnyNumberOfThreads) {
  CoverageScene scene = coverage_scenes().front();
  scene.plan.theta_r_deg = {15.0, 45.0};
  const auto prepared = prepare(scene);
  ASSERT_TRUE(prepared) << describe(prepared.error());

  const auto one = compare_budget(*prepared, 32, kSeed, 1);
  const auto three = compare_budget(*prepared, 32, kSeed, 3);

  ASSERT_TRUE(one && three);
  EXPECT_EQ(one->ratio, three->ratio);
}

TEST(CoverageHarness, KnowsAtLeastTwelveScenesEachWithSeedsOfItsOwn) {
  std::vector<std::uint64_t> seeds;
  for (const CoverageScene& scene : coverage_scenes()) seeds.push_back(scene.first_seed);
  std::ranges::sort(seeds);

  EXPECT_GE(seeds.size(), 12U);
  constexpr std::uint64_t kRepetitionsAtMost = 1'000'000;
  for (std::size_t k = 1; k < seeds.size(); ++k) EXPECT_GE(seeds[k] - seeds[k - 1], kRepetitionsAtMost);
}

}  // namespace
}  // namespace gonio::coverage
