#include "cli/scan_comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cli/replay_program.h"

namespace gonio::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

api::BrdfReport value(std::int64_t point, double brdf_per_sr, double u_own_per_sr, double k = 2.0) {
  api::BrdfReport report;
  report.point = point;
  report.brdf_per_sr = brdf_per_sr;
  report.u_random_per_sr = u_own_per_sr / 2.0;
  report.u_own_per_sr = u_own_per_sr;
  report.k = k;
  return report;
}

TEST(ScanComparison, GivesTheDifferenceInUnitsOfItsExpandedUncertainty) {
  const ScanComparison found = compare_values({value(0, 0.30, 0.003)}, {value(0, 0.32, 0.004, 2.5)});

  // u = hypot(3, 4) = 5 thousandths; U = 2.5 u; chi-square = (20 / 5)^2.
  ASSERT_EQ(found.points.size(), 1U);
  EXPECT_NEAR(found.points[0].difference, 0.02, 1e-15);
  EXPECT_NEAR(found.points[0].expanded_u, 0.0125, 1e-15);
  EXPECT_NEAR(found.points[0].difference_in_u, 1.6, 1e-12);
  EXPECT_NEAR(found.chi_square, 16.0, 1e-10);
}

TEST(ScanComparison, PairsByPointAndCountsThoseWithoutAPartner) {
  api::BrdfReport blocked;
  blocked.point = 5;

  const ScanComparison found = compare_values({value(1, 1.0, 0.1), value(2, 1.0, 0.1), blocked},
                                              {value(2, 1.1, 0.1), value(3, 1.0, 0.1), value(1, 1.3, 0.1), blocked});

  ASSERT_EQ(found.points.size(), 2U);
  EXPECT_EQ(found.points[1].a.point, 2);
  ASSERT_TRUE(found.worst.has_value());
  EXPECT_EQ(found.points[*found.worst].a.point, 1);
  const ScanComparison missing = compare_values({value(1, 1.0, 0.1)}, {blocked});
  EXPECT_EQ(missing.without_a_value, 1);
  EXPECT_EQ(summary_of(missing), "no point has a value in both scans");
}

TEST(ScanComparison, TakesTheRandomPartWhereADaemonTellsNoOther) {
  api::BrdfReport a = value(0, 1.0, 0.2);
  a.u_own_per_sr.reset();

  EXPECT_NEAR(compare_values({a}, {a}).points.at(0).expanded_u, 2.0 * std::hypot(0.1, 0.1), 1e-15);
}

TEST(ScanComparison, SaysWhetherChanceExplainsIt) {
  std::vector<api::BrdfReport> a;
  std::vector<api::BrdfReport> near;
  std::vector<api::BrdfReport> far;
  for (int point = 0; point < 10; ++point) {
    a.push_back(value(point, 1.0, 0.01));
    near.push_back(value(point, point % 2 == 0 ? 1.01 : 0.99, 0.01));
    far.push_back(value(point, 1.04, 0.01));
  }

  EXPECT_TRUE(compare_values(a, near).do_agree());
  EXPECT_FALSE(compare_values(a, far).do_agree());
  EXPECT_THAT(summary_of(compare_values(a, far)),
              HasSubstr("for 10 points; worst point 0: +1.41 U; they do not agree"));
}

TEST(ReplayProgram, IsTheGoniodBesideThisProgram) {
  EXPECT_THAT(replay_command({.tape = "night.tape", .against = "old.sqlite", .instrument = "other.toml"},
                             "/opt/goniod/bin/gonioctl"),
              ElementsAre("/opt/goniod/bin/goniod", "--replay", "night.tape", "--store", "night.tape.sqlite",
                          "--log-level", "error", "--against", "old.sqlite", "--instrument", "other.toml"));
}

}  // namespace
}  // namespace gonio::cli
