#include "calibration/budget.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "calibration/student_t.h"

namespace gonio::calibration {
namespace {

Brdf f(double value) {
  return per_steradian(value);
}

/// A budget with the columns that it refers to.
struct Made {
  TermColumns columns;
  Budget budget;
  Made(const std::vector<Component>& components, std::vector<BudgetTerm> random, std::vector<BudgetTerm> shared)
      : budget(make_budget(components, random, shared, columns)) {}
};

// JCGM 100:2008, table G.2, column 95.45 %.
TEST(CoverageFactor, IsThatOfTheGuidesTable) {
  const std::vector<std::pair<double, double>> rows = {{1, 13.97}, {2, 4.53},  {3, 3.31},  {4, 2.87},
                                                       {5, 2.65},  {10, 2.28}, {20, 2.13}, {50, 2.05}};

  for (const auto& [nu, k] : rows) EXPECT_NEAR(coverage_factor(nu), k, 0.0051) << nu << " degrees of freedom";
  EXPECT_NEAR(coverage_factor(1e5), 2.0, 1e-4);
  EXPECT_DOUBLE_EQ(coverage_factor(INFINITY), 2.0);
}

// P(|t| < k) is 2 atan(k) / pi for one degree of freedom, k / sqrt(2 + k^2) for two.
TEST(StudentFactor, IsTheClosedFormOfOneAndOfTwoDegreesOfFreedom) {
  constexpr double kLevel = 0.9545;
  const double of_one = std::tan(0.5 * std::numbers::pi * kLevel);
  const double of_two = kLevel * std::sqrt(2.0 / (1.0 - kLevel * kLevel));

  EXPECT_NEAR(student_factor(1.0), of_one, 1e-9);
  EXPECT_NEAR(exact_student_factor(1.0), of_one, 1e-9);
  EXPECT_NEAR(student_factor(2.0), of_two, 1e-9);
  EXPECT_NEAR(exact_student_factor(2.0), of_two, 1e-9);
}

TEST(StudentFactor, IsTheDistributionsOwnBetweenTheNodesOfItsTable) {
  for (double nu = 1.0; nu < 210.0; nu *= 1.0137) {
    EXPECT_NEAR(student_factor(nu), exact_student_factor(nu), 1e-9) << nu << " degrees of freedom";
  }
  EXPECT_NEAR(student_factor(0.7), exact_student_factor(0.7), 1e-9);
}

TEST(Budget, AddsRandomAndSharedPartsAsSquares) {
  const std::vector<Component> components(3);

  const Made made(components, {{0, f(3.0)}}, {{1, f(-4.0)}, {2, f(12.0)}});
  const Budget& budget = made.budget;

  EXPECT_DOUBLE_EQ(budget.u_random.si(), 3.0);
  EXPECT_DOUBLE_EQ(budget.u_shared.si(), std::sqrt(160.0));
  EXPECT_DOUBLE_EQ(budget.u.si(), 13.0);
  EXPECT_DOUBLE_EQ(budget.k, 2.0);
  EXPECT_DOUBLE_EQ(budget.expanded.si(), 26.0);
}

TEST(Budget, LetsTwoSensitivitiesToTheSameErrorCancel) {
  const std::vector<Component> components(2);

  const Made made(components, {}, {{1, f(5.0)}, {0, f(1.0)}, {1, f(-5.0)}});
  const Budget& budget = made.budget;

  ASSERT_EQ(budget.shared.size(), 1U);
  EXPECT_EQ(budget.shared[0].component, 0U);
  EXPECT_DOUBLE_EQ(budget.u.si(), 1.0);
}

// JCGM 100:2008, eq G.2b: u^4 / sum(u_i^4 / nu_i) = 25^2 / (16^2 / 8) with 3 known exactly and 4 from 9 repeats.
TEST(Budget, TakesKFromTheEffectiveDegreesOfFreedom) {
  std::vector<Component> components(2);
  components[1].degrees_of_freedom = 8.0;

  const Made made(components, {{1, f(4.0)}}, {{0, f(3.0)}});
  const Budget& budget = made.budget;

  EXPECT_NEAR(budget.degrees_of_freedom, 625.0 / 32.0, 1e-12);
  EXPECT_NEAR(budget.k, 2.13, 0.01);
  EXPECT_DOUBLE_EQ(budget.expanded.si(), budget.k * 5.0);
}

TEST(WeightedSum, KeepsSharedErrorsTogetherAndRandomOnesApart) {
  const std::vector<Component> components(3);
  const Made made_a(components, {{0, f(3.0)}}, {{1, f(2.0)}, {2, f(1.0)}});
  const Budget& a = made_a.budget;
  const Made made_b(components, {{0, f(4.0)}}, {{1, f(2.0)}, {2, f(-1.0)}});
  const Budget& b = made_b.budget;
  const std::vector<SumTerm> terms = {{1.0, f(10.0), &a}, {1.0, f(20.0), &b}};

  const auto sum = weighted_sum(components, terms);

  EXPECT_DOUBLE_EQ(sum.value.si(), 30.0);
  EXPECT_DOUBLE_EQ(sum.u.si(), std::sqrt(9.0 + 16.0 + 16.0));  // component 2 cancels
}

// Two planes that nobody knows: the signs of both parts of each are kept, and their sum has bounds.
TEST(WeightedSum, TakesKFromBoundsAndFromFewDegreesOfFreedomAsAPointDoes) {
  std::vector<Component> components(3);
  components[0].distribution = components[1].distribution = Distribution::Arcsine;
  components[2].degrees_of_freedom = 8.0;
  const Made lone(components, {}, {{0, f(3.0)}, {1, f(4.0)}});
  const Made turned(components, {}, {{0, f(-3.0)}, {1, f(4.0)}});
  const Made uncertain(components, {}, {{2, f(1.0)}});

  const auto one = weighted_sum(components, std::vector<SumTerm>{{1.0, f(10.0), &lone.budget}});
  const auto both =
      weighted_sum(components, std::vector<SumTerm>{{1.0, f(10.0), &lone.budget}, {1.0, f(10.0), &turned.budget}});
  const auto few = weighted_sum(
      components, std::vector<SumTerm>{{1.0, f(10.0), &uncertain.budget}, {2.0, f(1.0), &uncertain.budget}});

  EXPECT_EQ(one.k, lone.budget.k);
  EXPECT_EQ(lone.budget.method, BudgetMethod::FormulaWithBounds);
  EXPECT_NEAR(one.k, std::numbers::sqrt2 * std::sin(0.5 * std::numbers::pi * 0.9545), 0.007);
  EXPECT_DOUBLE_EQ(both.u.si(), 8.0);  // one part of the plane cancels, the other doubles
  EXPECT_NEAR(both.k, one.k, 1e-9);
  EXPECT_NEAR(few.degrees_of_freedom, 8.0, 1e-9);
  EXPECT_NEAR(few.k, 2.37, 0.01);
}

// Four errors of one estimate know no more of their size than the one would.
TEST(Budget, PartsOfOneEstimateHaveItsDegreesOfFreedomTogether) {
  const Component whole{.name = "wander", .u = 1.0, .degrees_of_freedom = 8.0};
  Component part = whole;
  part.is_of_the_wander = true;
  const std::vector<Component> one = {whole};
  const std::vector<Component> parts(4, part);
  std::vector<BudgetTerm> halves;
  for (std::uint32_t k = 0; k < 4; ++k) halves.push_back({k, per_steradian(0.5)});

  const Made together(parts, {}, halves);

  EXPECT_NEAR(together.budget.degrees_of_freedom, 8.0, 1e-12);
  EXPECT_NEAR(together.budget.k, Made(one, {}, {{0, per_steradian(1.0)}}).budget.k, 1e-12);
}

}  // namespace
}  // namespace gonio::calibration
