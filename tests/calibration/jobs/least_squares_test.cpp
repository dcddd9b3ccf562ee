#include "calibration/jobs/least_squares.h"

#include <gtest/gtest.h>

#include <array>

namespace gonio::calibration {
namespace {

constexpr std::array<std::size_t, 2> kBoth{0, 1};

// y = 1 + 2 x through three points exactly; (X^T X)^-1 of x = 0, 1, 2 is [[5, -3], [-3, 3]] / 6.
TEST(LeastSquares, FindsALineWithTheCovarianceOfItsNormalEquations) {
  LeastSquares squares(2);
  for (const double x : {0.0, 1.0, 2.0}) {
    const std::array<double, 2> row{1.0, x};
    squares.add(1.0 + 2.0 * x, kBoth, row);
  }

  const auto step = squares.solve();

  ASSERT_TRUE(step) << describe(step.error());
  EXPECT_NEAR(step->change[0], 1.0, 1e-12);
  EXPECT_NEAR(step->change[1], 2.0, 1e-12);
  EXPECT_NEAR(step->covariance[0], 5.0 / 6.0, 1e-12);
  EXPECT_NEAR(step->covariance[1], -0.5, 1e-12);
  EXPECT_NEAR(step->covariance[3], 0.5, 1e-12);
}

TEST(LeastSquares, TakesParametersOfVeryDifferentSizes) {
  LeastSquares squares(2);
  for (const double x : {0.0, 1.0, 2.0}) {
    const std::array<double, 2> row{1e9, 1e-9 * x};
    squares.add(3.0 + 4.0 * x, kBoth, row);
  }

  const auto step = squares.solve();

  ASSERT_TRUE(step) << describe(step.error());
  EXPECT_NEAR(step->change[0], 3e-9, 1e-18);
  EXPECT_NEAR(step->change[1], 4e9, 1.0);
}

TEST(LeastSquares, RefusesRowsThatLeaveAParameterOpen) {
  LeastSquares squares(2);
  for (const double x : {1.0, 2.0, 3.0}) {
    const std::array<double, 2> row{x, 2.0 * x};
    squares.add(x, kBoth, row);
  }

  const auto step = squares.solve();

  ASSERT_FALSE(step);
  EXPECT_EQ(step.error().code, ErrorCode::IncompleteData);
}

TEST(LeastSquares, LetsPriorKnowledgeStandForWhatTheRowsLeaveOpen) {
  LeastSquares squares(2);
  const std::array<double, 2> difference{1.0 / 0.001, -1.0 / 0.001};
  squares.add(0.06 / 0.001, kBoth, difference);
  for (const std::size_t place : kBoth) {
    const double slope = 1.0 / 0.02;
    squares.add(0.0, std::span(&place, 1), std::span(&slope, 1));
  }

  const auto step = squares.solve();

  ASSERT_TRUE(step);
  // Each takes half of the difference (less what the prior resists); the sum stays as uncertain as stated.
  EXPECT_NEAR(step->change[0], 0.03, 1e-4);
  EXPECT_NEAR(step->change[1], -0.03, 1e-4);
  const auto& v = step->covariance;
  EXPECT_NEAR(v[0] + v[3] + 2.0 * v[1], 2.0 * 0.02 * 0.02, 1e-9);
  EXPECT_NEAR(v[0] + v[3] - 2.0 * v[1], 1e-6, 1e-8);
}

}  // namespace
}  // namespace gonio::calibration
