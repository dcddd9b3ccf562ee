// The shapes of a plan, from its text to its points.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "daemon/planner/gauss_rings.h"
#include "daemon/planner/planner.h"
#include "tests/daemon/support/bench_instrument.h"

namespace gonio::daemon {
namespace {

using test::bench_instrument;
using testing::HasSubstr;
using Files = std::map<std::string, std::string>;

Result<PlannedScan> planned(const std::string& geometry, const Files& files = {}, const std::string& scan = {}) {
  const std::string text = "[scan]\nname = 'n'\nsample = 's'\n" + scan + "[geometry]\n" + geometry +
                           "\n[reference]\nstandard = 'SRT-1'\n[order]\nstrategy = 'as-written'\n";
  const auto plan = api::parse_plan(text, "plan.toml", files);
  if (!plan) return failure(plan.error());
  return expand(*plan, bench_instrument());
}

std::string text_of(const ScanPoint& p) {
  char text[96];
  std::snprintf(text, sizeof text, "%g %g %g %g", in_degrees(p.geometry.theta_i), in_degrees(p.geometry.phi_i),
                in_degrees(p.geometry.theta_r), in_degrees(p.geometry.phi_r));
  return text;
}

std::vector<std::string> texts_of(const PlannedScan& scan) {
  std::vector<std::string> texts;
  for (const ScanPoint& p : scan.points) texts.push_back(text_of(p));
  return texts;
}

double angle_between_deg(Angle theta_a, Angle phi_a, Angle theta_b, Angle phi_b) {
  const double cosine = std::cos(theta_a.si()) * std::cos(theta_b.si()) +
                        std::sin(theta_a.si()) * std::sin(theta_b.si()) * std::cos((phi_a - phi_b).si());
  return in_degrees(radians(std::acos(std::clamp(cosine, -1.0, 1.0))));
}

TEST(PlanParts, AListIsTakenAsItIsWritten) {
  const auto scan =
      planned("wavelength_nm = [568]\npoints = 'p.csv'",
              {{"p.csv", "theta_r_deg, theta_i_deg, phi_r_deg\n# a peak\n10, 30, 180\n\n20.5, 30, 90\r\n"}});

  ASSERT_TRUE(scan) << describe(scan.error());
  EXPECT_EQ(texts_of(*scan), (std::vector<std::string>{"30 0 10 180", "30 0 20.5 90"}));
}

TEST(PlanParts, AListMayHaveItsOwnWavelengthsAndAzimuthsOfTheSource) {
  const auto scan = planned(
      "points = 'p.csv'", {{"p.csv", "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,wavelength_nm\n30,15,10,90,568\n"}});

  ASSERT_TRUE(scan) << describe(scan.error());
  EXPECT_EQ(texts_of(*scan), std::vector<std::string>{"30 15 10 105"});  // isotropic: phi_r counts from phi_i
}

TEST(PlanParts, ARefusalOfAListedPointNamesTheListItsLineAndTheField) {
  const auto beyond = planned("wavelength_nm = [568]\npoints = 'p.csv'",
                              {{"p.csv", "theta_i_deg,theta_r_deg,phi_r_deg\n30,10,90\n30,88,90\n"}});

  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().code, ErrorCode::OutOfLimits);
  EXPECT_EQ(beyond.error().where, (InputLocation{"p.csv", 3, "theta_r_deg"}));
}

TEST(PlanParts, GaussRingsOfALambertianSurfaceSumToItsReflectance) {
  // rho over theta < to of f = 1 / pi is sin^2(to), whatever the number of rings.
  for (const int count : {1, 2, 7, 40}) {
    double sum = 0.0;
    for (const auto& ring : gauss_rings(count, degrees(75))) sum += ring.weight / std::numbers::pi;
    EXPECT_NEAR(sum, std::pow(std::sin(75.0 * std::numbers::pi / 180.0), 2), 1e-14) << count;
  }
}

TEST(PlanParts, GaussRingsStandAtThePrintedNodes) {
  // Abramowitz and Stegun (1964), table 25.4, n = 5: x and w on [-1, 1]. Here u = cos^2 = 1 - (1 - x) / 2 over [0, 1].
  const std::vector<std::pair<double, double>> table{{0.906179845938664, 0.236926885056189},
                                                     {0.538469310105683, 0.478628670499366},
                                                     {0.0, 0.568888888888889},
                                                     {-0.538469310105683, 0.478628670499366},
                                                     {-0.906179845938664, 0.236926885056189}};

  const auto rings = gauss_rings(5, degrees(90));

  ASSERT_EQ(rings.size(), 5U);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(std::pow(std::cos(rings[k].theta.si()), 2), 0.5 * (1.0 + table[k].first), 1e-14) << k;
    EXPECT_NEAR(rings[k].weight, 0.5 * std::numbers::pi * table[k].second, 1e-14) << k;
  }
}

TEST(PlanParts, RingsReachAsFarAsTheArmAndStayOffThePlaneOfIncidence) {
  const auto scan = planned("theta_i_deg = [30]\nwavelength_nm = [568]\nrings = {gauss = 4, around = 6}");
  const auto half = planned("theta_i_deg = [30]\nwavelength_nm = [568]\nrings = {gauss = 4, around = 6, half = true}");

  ASSERT_TRUE(scan && half) << describe(scan.error());
  EXPECT_EQ(scan->points.size(), 24U);
  const auto rings = gauss_rings(4, degrees(85));  // the axis' limit
  for (std::size_t k = 0; k < 24; ++k) {
    EXPECT_NEAR(in_degrees(scan->points[k].geometry.theta_r), in_degrees(rings[k / 6].theta), 1e-6);
    EXPECT_NEAR(in_degrees(scan->points[k].geometry.phi_r), 30.0 + 60.0 * static_cast<double>(k % 6), 1e-6);
  }
  EXPECT_NEAR(in_degrees(half->points[5].geometry.phi_r), 165.0, 1e-6);
}

TEST(PlanParts, AConeIsFineAtItsPeakAndCoarseAtItsRim) {
  const auto scan = planned(
      "theta_i_deg = [40]\nwavelength_nm = [568]\n"
      "cone = {about = 'specular', half_angle_deg = 20, finest_deg = 0.5, coarsest_deg = 5}");

  ASSERT_TRUE(scan) << describe(scan.error());
  EXPECT_EQ(text_of(scan->points.front()), "40 0 40 180");
  const auto from_peak = [](const ScanPoint& p) {
    return angle_between_deg(p.geometry.theta_r, p.geometry.phi_r, degrees(40), degrees(180));
  };
  const auto nearest = [&](const ScanPoint& p) {
    double least = 1e9;
    for (const ScanPoint& q : scan->points) {
      if (q.index == p.index) continue;
      least = std::min(least,
                       angle_between_deg(p.geometry.theta_r, p.geometry.phi_r, q.geometry.theta_r, q.geometry.phi_r));
    }
    return least;
  };
  for (const ScanPoint& p : scan->points) {
    ASSERT_LE(from_peak(p), 20.0 + 1e-4);
    const double spacing = 0.5 + 4.5 * from_peak(p) / 20.0;  // as the README has it
    EXPECT_LE(nearest(p), 1.001 * spacing) << text_of(p);
    EXPECT_GE(nearest(p), 0.45 * spacing) << text_of(p);
  }
}

TEST(PlanParts, AConeLosesWhatTheArmsDoNotReachAndCountsIt) {
  const std::string cone =
      "wavelength_nm = [568]\ncone = {about = 'specular', half_angle_deg = 12, finest_deg = 2, coarsest_deg = 4}";
  const auto inside = planned("theta_i_deg = [40]\n" + cone);
  const auto at_rim = planned("theta_i_deg = [80]\n" + cone);

  ASSERT_TRUE(inside && at_rim);
  EXPECT_EQ(inside->out_of_reach, 0);
  EXPECT_GT(at_rim->out_of_reach, 0);
  for (const ScanPoint& p : at_rim->points) EXPECT_LE(in_degrees(p.geometry.theta_r), 85.0);
}

TEST(PlanParts, ARegionIsFilledEvenly) {
  const auto box = planned(
      "theta_i_deg = [30]\nwavelength_nm = [568]\n"
      "region = {theta_r_deg = [30, 60], phi_r_deg = [90, 150], spacing_deg = 10}");

  ASSERT_TRUE(box) << describe(box.error());
  // By hand: rows at 30, 40, 50, 60 deg; sin(theta) * 60 / 10 asks for 3, 4, 5, 6 steps.
  std::map<double, int> rows;
  for (const ScanPoint& p : box->points) ++rows[std::round(in_degrees(p.geometry.theta_r))];
  EXPECT_EQ(rows, (std::map<double, int>{{30, 4}, {40, 5}, {50, 6}, {60, 7}}));
}

TEST(PlanParts, PartsTakeWhatTheyDoNotSayFromGeometryAndOverlapIsMergedAndCounted) {
  const auto scan = planned(
      "theta_i_deg = [30]\nwavelength_nm = [568]\n"
      "[[geometry.parts]]\ntheta_r_deg = [10, 20]\nphi_r_deg = [90]\n"
      "[[geometry.parts]]\ntheta_r_deg = [20, 40]\nphi_r_deg = [90, 450]\n"
      "[[geometry.parts]]\ntheta_i_deg = [0]\ntheta_r_deg = [20]\nphi_r_deg = [0]\n");

  ASSERT_FALSE(scan);  // 450 is no azimuth
  const auto overlapping = planned(
      "theta_i_deg = [30]\nwavelength_nm = [568]\n"
      "[[geometry.parts]]\ntheta_r_deg = [10, 20]\nphi_r_deg = [90]\n"
      "[[geometry.parts]]\ntheta_r_deg = [20, 40]\nphi_r_deg = [90, -270]\n"
      "[[geometry.parts]]\ntheta_i_deg = [0]\ntheta_r_deg = [20]\nphi_r_deg = [0]\n");
  ASSERT_TRUE(overlapping) << describe(overlapping.error());
  EXPECT_EQ(texts_of(*overlapping), (std::vector<std::string>{"30 0 10 90", "30 0 20 90", "30 0 40 90", "0 0 20 0"}));
  EXPECT_EQ(overlapping->asked, 7);
  EXPECT_EQ(overlapping->merged, 3);
}

TEST(PlanParts, RepeatsArePointsOfTheirOwn) {
  const auto scan =
      planned("theta_i_deg = [30]\ntheta_r_deg = [10, 20]\nphi_r_deg = [90]\nwavelength_nm = [568]\nrepeats = 3");

  ASSERT_TRUE(scan) << describe(scan.error());
  ASSERT_EQ(scan->points.size(), 6U);
  EXPECT_EQ(scan->items, 12);
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(scan->points[static_cast<std::size_t>(k)].index, k);
    EXPECT_EQ(scan->points[static_cast<std::size_t>(k)].repeat, 1 + k % 3);
  }
}

TEST(PlanParts, ReciprocalPairsAreAddedOnceAndThoseOutOfReachAreNamed) {
  Instrument narrow = bench_instrument();
  narrow.stage.axes[stage::index_of(stage::Axis::ThetaI)].high = 50.0;
  const auto plan = api::parse_plan(
      "[scan]\nname = 'n'\nsample = 's'\n[geometry]\nreciprocal = true\ntheta_i_deg = [30]\n"
      "theta_r_deg = [10, 30, 60]\nphi_r_deg = [120]\nwavelength_nm = [568]\n[reference]\nstandard = 'x'\n",
      "plan.toml");
  ASSERT_TRUE(plan) << describe(plan.error());

  const auto scan = expand(*plan, narrow);

  ASSERT_TRUE(scan) << describe(scan.error());
  // 30 -> 10 has the partner 10 -> 30 at -120; 30 -> 30 the one at -120; 60 cannot be the source's.
  EXPECT_EQ(texts_of(*scan),
            (std::vector<std::string>{"30 0 10 120", "30 0 30 120", "30 0 60 120", "10 0 30 -120", "30 0 30 -120"}));
  EXPECT_EQ(scan->without_partner, std::vector<std::int32_t>{2});
}

TEST(PlanParts, AnAzimuthIsAbsoluteWhereThePlanSaysSo) {
  const std::string lists =
      "theta_i_deg = [30]\nphi_i_deg = [20]\ntheta_r_deg = [10]\nphi_r_deg = [90]\nwavelength_nm = [568]\n";

  const auto relative = planned(lists);
  const auto absolute = planned(lists + "relative_azimuth = false");
  const auto turned = planned(lists + "relative_azimuth = true", {}, "isotropic = false\n");

  ASSERT_TRUE(relative && absolute && turned);
  EXPECT_EQ(text_of(relative->points[0]), "30 20 10 110");
  EXPECT_EQ(text_of(absolute->points[0]), "30 20 10 90");
  EXPECT_EQ(text_of(turned->points[0]), "30 20 10 110");
}

struct Refused {
  std::string geometry;
  ErrorCode code;
  InputLocation where;
};

TEST(PlanParts, AWrongShapeIsRefusedWithFileLineAndField) {
  const std::string lists = "theta_i_deg = [30]\nwavelength_nm = [568]\n";
  const std::string head = "theta_i_deg,theta_r_deg,phi_r_deg\n";
  const Files files{{"bad.csv", head + "30,10,90\n30,ten,90\n"},
                    {"range.csv", head + "30,95,90\n"},
                    {"short.csv", head + "30,10\n"},
                    {"name.csv", "theta_i_deg,theta_q_deg,phi_r_deg\n"},
                    {"lost.csv", "theta_i_deg,phi_r_deg\n"},
                    {"empty.csv", head}};
  const std::vector<Refused> table{
      {lists + "points = 'none.csv'", ErrorCode::InvalidInput, {"plan.toml", 7, "geometry.points"}},
      {lists + "points = 'bad.csv'", ErrorCode::InvalidInput, {"bad.csv", 3, "theta_r_deg"}},
      {lists + "points = 'range.csv'", ErrorCode::InvalidInput, {"range.csv", 2, "theta_r_deg"}},
      {lists + "points = 'short.csv'", ErrorCode::InvalidInput, {"short.csv", 2, ""}},
      {lists + "points = 'name.csv'", ErrorCode::UnknownKey, {"name.csv", 1, "theta_q_deg"}},
      {lists + "points = 'lost.csv'", ErrorCode::MissingKey, {"lost.csv", 1, "theta_r_deg"}},
      {lists + "points = 'empty.csv'", ErrorCode::InvalidInput, {"empty.csv", 1, ""}},
      {lists + "rings = {gauss = 0, around = 4}", ErrorCode::InvalidInput, {"plan.toml", 7, "geometry.rings.gauss"}},
      {lists + "cone = {about = 'retro', half_angle_deg = 5, finest_deg = 2, coarsest_deg = 1}",
       ErrorCode::InvalidInput,
       {"plan.toml", 7, "geometry.cone.coarsest_deg"}},
      {lists + "region = {theta_r_deg = [60, 30], phi_r_deg = [0, 1], spacing_deg = 1}",
       ErrorCode::InvalidInput,
       {"plan.toml", 7, "geometry.region.theta_r_deg"}},
      {"wavelength_nm = [568]\nrings = {gauss = 3, around = 4}",
       ErrorCode::MissingKey,
       {"plan.toml", 4, "geometry.theta_i_deg"}},
  };

  for (const Refused& wrong : table) {
    SCOPED_TRACE(wrong.geometry);
    const auto scan = planned(wrong.geometry, files);

    ASSERT_FALSE(scan);
    EXPECT_EQ(scan.error().code, wrong.code) << describe(scan.error());
    ASSERT_TRUE(scan.error().where);
    EXPECT_EQ(*scan.error().where, wrong.where) << describe(scan.error());
  }
}

TEST(PlanParts, SeveralShapesInOnePartAreRefused) {
  const auto scan = planned("theta_i_deg = [30]\nwavelength_nm = [568]\npoints = 'a'\nrings = {gauss = 3, around = 4}");

  ASSERT_FALSE(scan);
  EXPECT_THAT(describe(scan.error()), HasSubstr("several shapes"));
}

}  // namespace
}  // namespace gonio::daemon
