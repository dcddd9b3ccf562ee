#include "calibration/jobs/control_chart.h"

#include <gtest/gtest.h>

namespace gonio::calibration {
namespace {

// Ten runs of mean 1 and standard deviation 0.01: five at 1 + d, five at 1 - d, d = 0.01 sqrt(0.9).
std::vector<ChartRun> baseline() {
  constexpr double kD = 0.00948683298;
  std::vector<ChartRun> runs;
  for (int k = 0; k < 10; ++k) runs.push_back({.value = 1.0 + (k % 2 == 0 ? kD : -kD), .u_own = 0.002});
  return runs;
}

std::vector<ChartRun> baseline_and(const std::vector<double>& more) {
  std::vector<ChartRun> runs = baseline();
  for (const double deviation : more) runs.push_back({.value = 1.0 + 0.01 * deviation, .u_own = 0.002});
  return runs;
}

std::string last_broken(const std::vector<double>& more) {
  return broken_rules_text(control_chart(baseline_and(more)).runs.back().broken);
}

TEST(ControlChart, TakesCentreAndLimitsFromTheFirstTenRuns) {
  const ControlChart chart = control_chart(baseline_and({5.0, 5.0}));

  EXPECT_EQ(chart.baseline, 10U);
  EXPECT_NEAR(chart.centre, 1.0, 1e-12);
  EXPECT_NEAR(chart.sd, 0.01, 1e-8);
  EXPECT_NEAR(chart.low(), 0.97, 1e-7);
  EXPECT_NEAR(chart.high(), 1.03, 1e-7);
  for (std::size_t k = 0; k < 10; ++k) EXPECT_EQ(chart.runs[k].broken, 0) << k;
}

TEST(ControlChart, JudgesNothingBeforeFiveRuns) {
  std::vector<ChartRun> runs = baseline();
  runs.resize(4);
  runs.back().value = 9.0;

  const ControlChart chart = control_chart(runs);

  EXPECT_EQ(chart.baseline, 0U);
  EXPECT_EQ(chart.runs.back().broken, 0);
}

TEST(ControlChart, BreaksOneRuleForOneRunBeyondThree) {
  EXPECT_EQ(last_broken({-3.2}), "beyond 3 sd");
  EXPECT_EQ(last_broken({2.8}), "");
}

TEST(ControlChart, BreaksARuleForTwoOfThreeBeyondTwoOnOneSide) {
  EXPECT_EQ(last_broken({2.3, 0.1, 2.4}), "two of three beyond 2 sd");
  EXPECT_EQ(last_broken({-2.3, 0.1, 2.4}), "");
  EXPECT_EQ(last_broken({2.3, 2.3, 0.1}), "") << "the last one is in its place again";
}

TEST(ControlChart, BreaksARuleForFourOfFiveBeyondOneOnOneSide) {
  EXPECT_EQ(last_broken({-1.2, -1.3, -0.2, -1.4, -1.1}), "four of five beyond 1 sd");
}

TEST(ControlChart, BreaksARuleForEightOnOneSide) {
  EXPECT_EQ(last_broken({0.5, 0.2, 0.3, 0.1, 0.6, 0.4, 0.2, 0.5}), "eight on one side");
  EXPECT_EQ(last_broken({-0.5, 0.2, 0.3, 0.1, 0.6, 0.4, 0.2}), "");
}

TEST(ControlChart, IsNeverTighterThanTheRunsOwnUncertainty) {
  std::vector<ChartRun> runs = baseline();
  for (ChartRun& run : runs) run.u_own = 0.03;

  EXPECT_NEAR(control_chart(runs).sd, 0.03, 1e-12);
}

}  // namespace
}  // namespace gonio::calibration
