#include "reflectance/check/chi_square.h"

#include <gtest/gtest.h>

#include <limits>

#include "reflectance/check/group_chi_square.h"
#include "tests/reflectance/printed.h"

namespace gonio::reflectance {
namespace {

TEST(ChiSquare, HasTheProbabilitiesOfTheTables) {
  // 5 % points as tables print them, and values of the incomplete gamma function with 40 digits.
  const struct {
    double chi2;
    double dof;
    Printed p;
  } rows[] = {{3.841458820694124, 1, "0.050000000000000058"},
              {7.814727903251178, 3, "0.050000000000000044"},
              {18.307038053275146, 10, "0.050000000000000013"},
              {0.5, 1, "0.47950012218695346"},
              {1e-10, 1, "0.9999920211543921"},
              {100, 1, "1.5239706048321052e-23"},
              {25, 7, "0.00075880025565825022"},
              {1.0, 10, "0.99982788437004416"},
              {80, 100, "0.92966493334060505"},
              {100, 100, "0.48119168452795672"},
              {120, 100, "0.08440668109369183"},
              {1100, 1000, "0.014614408126295194"},
              {1300, 2, "5.1119519486511562e-283"},
              {1e6, 1e6, "0.4998119368033945"},
              {1.004e6, 1e6, "0.0023630282386838922"}};
  for (const auto& row : rows) {
    EXPECT_TRUE(agrees(chi_square_probability(row.chi2, row.dof), row.p, 2e-13)) << row.chi2 << " " << row.dof;
  }
}

TEST(ChiSquare, IsCertainAtZeroAndImpossibleAtInfinity) {
  EXPECT_EQ(chi_square_probability(0.0, 5.0), 1.0);
  EXPECT_EQ(chi_square_probability(std::numeric_limits<double>::infinity(), 5.0), 0.0);
}

GroupMember member(double value, double u_random, std::vector<SharedEffect> shared = {}) {
  return {.value = value, .u_random = u_random, .shared = SharedEffects(shared)};
}

TEST(GroupChiSquare, IsTheSquareOfZForOnePair) {
  // u of the difference: sqrt(3^2 + 4^2 + (7 - 7)^2 + (2 - -10)^2) = 13.
  const std::vector<GroupMember> pair{member(100.0, 3.0, {{5, per_steradian(7.0)}, {9, per_steradian(2.0)}}),
                                      member(74.0, 4.0, {{9, per_steradian(-10.0)}, {5, per_steradian(7.0)}})};

  const Result<GroupChiSquare> chi = group_chi_square({{pair}});

  ASSERT_TRUE(chi);
  EXPECT_NEAR(chi->chi2, 4.0, 1e-13);
  EXPECT_EQ(chi->degrees_of_freedom, 1u);
}

TEST(GroupChiSquare, IsThatOfTheFullCovarianceForPairsThatErrTogether) {
  // Differences 3 and 5 of variance 2 each from noise, and (1 e, 2 e) from one shared error: C = [[3, 2], [2, 6]], so
  // d C^-1 d = (6 x 9 - 2 x 2 x 15 + 3 x 25) / 14 = 69 / 14.
  const SharedEffect one{3, per_steradian(1.0)};
  const SharedEffect two{3, per_steradian(2.0)};
  const std::vector<std::vector<GroupMember>> groups{{member(13.0, 1.0, {one}), member(10.0, 1.0)},
                                                     {member(25.0, 1.0, {two}), member(20.0, 1.0)}};

  const Result<GroupChiSquare> chi = group_chi_square(groups);

  ASSERT_TRUE(chi);
  EXPECT_NEAR(chi->chi2, 69.0 / 14.0, 1e-13);
  EXPECT_EQ(chi->degrees_of_freedom, 2u);
}

TEST(GroupChiSquare, TakesTheWeightedMeanOfALargerGroup) {
  // Values 1, 2, 6 with u 1, 1, 2: weights 1, 1, 1/4, mean 2: 1 + 0 + 16/4.
  const std::vector<GroupMember> group{member(1.0, 1.0), member(2.0, 1.0), member(6.0, 2.0)};

  const Result<GroupChiSquare> chi = group_chi_square({{group}});

  ASSERT_TRUE(chi);
  EXPECT_NEAR(chi->chi2, 5.0, 1e-14);
  EXPECT_EQ(chi->degrees_of_freedom, 2u);
}

TEST(GroupChiSquare, LeavesOutComponentsThatCancelAndRefusesTooManyThatDoNot) {
  std::vector<SharedEffect> many;
  for (std::uint32_t k = 0; k < 2049; ++k) many.push_back({k, per_steradian(0.1)});

  EXPECT_TRUE(group_chi_square({{{member(1.0, 1.0, many), member(2.0, 1.0, many)}}}));
  const Result<GroupChiSquare> refused = group_chi_square({{{member(1.0, 1.0, many), member(2.0, 1.0)}}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::InvalidInput);
}

}  // namespace
}  // namespace gonio::reflectance
