#include "tests/scenario/agreement.h"

#include <gtest/gtest.h>

namespace gonio::test {
namespace {

const auto kNone = [](const std::string&) { return false; };
const auto kAll = [](const std::string&) { return true; };

TEST(Agreement, HasTheTailsOfPrintedTables) {
  // NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.4: upper critical values.
  EXPECT_NEAR(chi_square_tail(3.841, 1), 0.05, 5e-5);
  EXPECT_NEAR(chi_square_tail(18.307, 10), 0.05, 5e-5);
  EXPECT_NEAR(chi_square_tail(29.588, 10), 0.001, 5e-6);
  EXPECT_NEAR(chi_square_tail(3.940, 10), 0.95, 5e-5);
  EXPECT_NEAR(chi_square_tail(124.342, 100), 0.05, 5e-5);
}

TEST(Agreement, AddsTheSquaresOfIndependentDifferences) {
  const std::map<long, StoredValue> a{{1, {1.0, 0.3, {}}}, {2, {2.0, 0.3, {}}}, {5, {9.0, 0.1, {}}}};
  const std::map<long, StoredValue> b{{1, {1.5, 0.4, {}}}, {2, {1.0, 0.4, {}}}};

  const ChiSquare chi = agreement(a, b, kNone);

  EXPECT_EQ(chi.degrees_of_freedom, 2);
  EXPECT_NEAR(chi.value, 1.0 + 4.0, 1e-12);
}

TEST(Agreement, TakesACommonShiftForWhatASharedComponentAllows) {
  // Both points of `a` are 1 too high; its shared component may do just that, so that only one direction of the two is
  // surprised: r^T C^-1 r with C = diag(2 * 0.01) + 1 (all), r = (1, 1): 2 / (2 + 0.02) = 0.990099.
  const std::map<long, StoredValue> a{{1, {2.0, 0.1, {{"dark", 1.0}}}}, {2, {3.0, 0.1, {{"dark", 1.0}}}}};
  const std::map<long, StoredValue> b{{1, {1.0, 0.1, {}}}, {2, {2.0, 0.1, {}}}};

  EXPECT_NEAR(agreement(a, b, kAll).value, 2.0 / 2.02, 1e-12);
  EXPECT_NEAR(agreement(a, b, kNone).value, 2.0 / 0.02, 1e-10);
}

}  // namespace
}  // namespace gonio::test
