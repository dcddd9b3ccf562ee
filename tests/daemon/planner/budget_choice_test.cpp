// A plan with a budget, from its text to what is kept of it.
#include "daemon/planner/budget_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "daemon/planner/planner.h"
#include "tests/daemon/support/bench_instrument.h"

namespace gonio::daemon {
namespace {

using test::bench_instrument;
using testing::HasSubstr;

struct Text {
  std::string geometry =
      "theta_i_deg = [0, 30, 60]\ntheta_r_deg = {from = 0, to = 80, step = 8}\nphi_r_deg = {from = "
      "45, to = 315, step = 30}\nwavelength_nm = [568]\n";
  std::string reading;
  std::string budget;
  std::string scan;
};

Result<PlannedScan> planned(const Text& text, const TimeExperience& experience = {}) {
  const std::string toml = "[scan]\nname = 'n'\nsample = 's'\n" + text.scan + "[geometry]\n" + text.geometry +
                           "[reading]\n" + text.reading + "[reference]\nstandard = 'SRT-1'\n" +
                           (text.budget.empty() ? "" : "[budget]\n" + text.budget);
  const auto plan = api::parse_plan(toml, "plan.toml");
  if (!plan) return failure(plan.error());
  return expand(*plan, bench_instrument(), experience);
}

double minutes_of(const PlannedScan& scan) {
  return in_seconds(scan.estimate.total()) / 60.0;
}

TEST(Budget, NeverTakesLongerThanIsAllowedAndLeavesLittleOfItUnused) {
  for (const double time_min : {1.0, 2.0}) {
    const auto scan = planned({.budget = "time_min = " + std::to_string(time_min) + "\n"});

    ASSERT_TRUE(scan) << describe(scan.error());
    EXPECT_LE(minutes_of(*scan), time_min);
    EXPECT_GE(minutes_of(*scan), 0.85 * time_min);
    ASSERT_TRUE(scan->budget);
    EXPECT_LT(scan->budget->kept, scan->budget->directions);
    EXPECT_EQ(scan->budget->kept, std::ssize(scan->order));
  }
}

TEST(Budget, KeepsEverythingThatFits) {
  const auto all = planned({});
  const auto scan = planned({.budget = "time_min = 1000\n"});

  ASSERT_TRUE(all && scan);
  EXPECT_EQ(scan->points.size(), all->points.size());
  EXPECT_EQ(scan->order, all->order);
  EXPECT_EQ(scan->budget->kept, scan->budget->directions);
  EXPECT_EQ(in_degrees(scan->budget->widest_gap), 0.0);
}

TEST(Budget, IsSharedOutTheSameEachTime) {
  const auto once = planned({.budget = "time_min = 1.5\n"});
  const auto again = planned({.budget = "time_min = 1.5\n"});

  ASSERT_TRUE(once && again);
  EXPECT_EQ(once->order, again->order);
  ASSERT_EQ(once->points.size(), again->points.size());
  for (std::size_t k = 0; k < once->points.size(); ++k) {
    EXPECT_EQ(once->points[k].geometry.theta_r, again->points[k].geometry.theta_r);
  }
}

TEST(Budget, WhatIsKeptLiesNearEverythingThatWasAskedFor) {
  const auto all = planned({});
  const auto scan = planned({.budget = "time_min = 1.2\n"});
  ASSERT_TRUE(all && scan);
  const auto vector_of = [](const Geometry& g) {
    return std::array{std::sin(g.theta_r.si()) * std::cos(g.phi_r.si()),
                      std::sin(g.theta_r.si()) * std::sin(g.phi_r.si()), std::cos(g.theta_r.si())};
  };
  double widest = 0.0;
  for (const ScanPoint& asked : all->points) {
    double nearest = 180.0;
    for (const ScanPoint& kept : scan->points) {
      if (kept.blocked || kept.geometry.theta_i != asked.geometry.theta_i) continue;
      const auto a = vector_of(asked.geometry);
      const auto b = vector_of(kept.geometry);
      const double cosine = std::clamp(a[0] * b[0] + a[1] * b[1] + a[2] * b[2], -1.0, 1.0);
      nearest = std::min(nearest, std::acos(cosine) * 180.0 / std::numbers::pi);
    }
    if (!asked.blocked) widest = std::max(widest, nearest);
  }

  const double share = static_cast<double>(scan->budget->kept) / static_cast<double>(scan->budget->directions);
  EXPECT_LT(share, 0.9);
  EXPECT_NEAR(in_degrees(scan->budget->widest_gap), widest, 1e-6) << "what the dry run says";
  EXPECT_LT(widest, 50.0) << share << " of the directions";
}

TEST(Budget, EveryPartIsRepresented) {
  const auto scan = planned(
      {.geometry = "[[geometry.parts]]\ntheta_i_deg = [20]\nwavelength_nm = [568]\ntheta_r_deg = {from = 0, to = 80, "
                   "step = 2}\nphi_r_deg = {from = 100, to = 300, step = 8}\n"
                   "[[geometry.parts]]\ntheta_i_deg = [70]\nwavelength_nm = [568]\ntheta_r_deg = [70]\nphi_r_deg = "
                   "[180]\n",
       .budget = "time_min = 1\n"});

  ASSERT_TRUE(scan) << describe(scan.error());
  EXPECT_TRUE(
      std::ranges::any_of(scan->points, [](const ScanPoint& p) { return in_degrees(p.geometry.theta_i) > 60; }));
}

TEST(Budget, LeavesOutRepeatsBeforeDirections) {
  const std::string geometry =
      "[[geometry.parts]]\nrepeats = 5\ntheta_i_deg = [30]\nwavelength_nm = [568]\ntheta_r_deg = {from = 0, to = 80, "
      "step = 8}\nphi_r_deg = {from = 60, to = 300, step = 40}\n";
  const auto once = planned({.geometry = geometry, .budget = "time_min = 1000\n"});
  ASSERT_TRUE(once);
  const double all_min = minutes_of(*once);

  const auto scan = planned({.geometry = geometry, .budget = "time_min = " + std::to_string(0.975 * all_min) + "\n"});

  ASSERT_TRUE(scan) << describe(scan.error());
  EXPECT_EQ(scan->budget->kept, scan->budget->directions);
  EXPECT_LT(scan->budget->kept_repeats, scan->budget->repeats);
  EXPECT_GT(scan->budget->kept_repeats, 0);
}

TEST(Budget, RingsLoseAzimuthsEvenlyAndAllRingsAlike) {
  const auto scan =
      planned({.geometry = "theta_i_deg = [80]\nwavelength_nm = [568]\nrings = {gauss = 8, around = 24, to_deg = 70}\n",
               .budget = "time_min = 2\n"});

  ASSERT_TRUE(scan) << describe(scan.error());
  std::map<double, std::set<double>> rings;
  for (const ScanPoint& point : scan->points) {
    rings[in_degrees(point.geometry.theta_r)].insert(in_degrees(point.geometry.phi_r));
  }
  ASSERT_EQ(rings.size(), 8U) << "no ring is left out";
  const std::set<double>& azimuths = rings.begin()->second;
  EXPECT_LT(azimuths.size(), 24U);
  EXPECT_EQ(24U % azimuths.size(), 0U);
  for (const auto& [theta, phi] : rings) EXPECT_EQ(phi.size(), azimuths.size()) << theta;
  for (auto a = azimuths.begin(); std::next(a) != azimuths.end(); ++a) {
    EXPECT_NEAR(*std::next(a) - *a, 360.0 / static_cast<double>(azimuths.size()), 1e-6);
  }
}

TEST(Budget, NoiseMayGrowBeforeAnythingIsLeftOutWhereThePlanAllowsIt) {
  // 2000 DN/s of white: 64 ms are 128 DN, and 300 needs frames enough to fill the second that a reading may take.
  const TimeExperience seen{.scans = 2, .white = {{nanometres(568.0), 2000.0}}};
  const Text text{.geometry =
                      "theta_i_deg = [30]\ntheta_r_deg = {from = 0, to = 80, step = 2}\nphi_r_deg = [90]\n"
                      "wavelength_nm = [568]\n",
                  .reading = "target_snr = 300\nmax_time_s = 1\n",
                  .scan = "expected_reflectance = 0.5\n"};
  Text unlimited = text;
  unlimited.budget = "time_min = 1000\n";
  const auto all = planned(unlimited, seen);
  ASSERT_TRUE(all) << describe(all.error());
  Text half = text;
  half.budget = "time_min = " + std::to_string(0.8 * minutes_of(*all)) + "\nleast_snr = 20\n";

  const auto scan = planned(half, seen);

  ASSERT_TRUE(scan) << describe(scan.error());
  EXPECT_EQ(scan->budget->kept, scan->budget->directions);
  EXPECT_LT(scan->budget->target_snr, 300.0);
  EXPECT_GE(scan->budget->target_snr, 20.0);
  EXPECT_LE(minutes_of(*scan), 0.8 * minutes_of(*all));
}

TEST(Budget, ThatTheLeastDoesNotFitIntoIsRefusedWithBothTimes) {
  const auto scan =
      planned({.budget = "time_min = 0.1\n", .scan = ""}, TimeExperience{.scans = 1, .beyond_s = {60.0, 1.0}});

  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(scan.error().where->field, "budget.time_min");
  EXPECT_EQ(scan.error().limit, "0.1 min");
  EXPECT_THAT(scan.error().seen, HasSubstr("min for 1 directions"));
}

TEST(Budget, ASignalToNoiseAboveTheTargetIsRefused) {
  const auto scan = planned({.reading = "target_snr = 100\n", .budget = "time_min = 5\nleast_snr = 200\n"});

  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().where->field, "budget.least_snr");
}

}  // namespace
}  // namespace gonio::daemon
