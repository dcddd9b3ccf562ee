// The budget by formula beside a Monte Carlo of its inputs. The long form demands 3 % with 20000 draws; here fewer
// draws have their own three standard errors on top.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "tests/coverage/budget_monte_carlo.h"

namespace gonio::coverage {

// Found by gtest beside the types.
void PrintTo(const CoverageScene& c, std::ostream* out) {
  *out << c.name;
}

namespace {

constexpr double kAgreement = 0.03;
constexpr int kDraws = 1500;
constexpr std::uint64_t kSeed = 77'000'000;

class BudgetByMonteCarlo : public testing::TestWithParam<CoverageScene> {};

TEST_P(BudgetByMonteCarlo, AgreesWithTheFormula) {
  SCOPED_TRACE(kSeed);
  const auto prepared = prepare(GetParam());
  ASSERT_TRUE(prepared) << describe(prepared.error());

  const auto compared = compare_budget(*prepared, kDraws, kSeed, 2);

  ASSERT_TRUE(compared) << describe(compared.error());
  std::printf("budget %s: Monte Carlo / formula %.4f (s.e. at most %.4f), single points %.3f to %.3f, %d draws\n",
              GetParam().name.c_str(), compared->ratio, compared->standard_error, compared->least_point,
              compared->largest_point, compared->draws);
  EXPECT_NEAR(compared->ratio, 1.0, kAgreement + 3.0 * compared->standard_error);
}

INSTANTIATE_TEST_SUITE_P(Scenes, BudgetByMonteCarlo, testing::ValuesIn(coverage_scenes()),
                         [](const testing::TestParamInfo<CoverageScene>& test) { return test.param.name; });

}  // namespace
}  // namespace gonio::coverage
