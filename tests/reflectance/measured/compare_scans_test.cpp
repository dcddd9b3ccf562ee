#include "reflectance/measured/compare_scans.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reflectance/check/symmetry_check.h"
#include "reflectance/measured/repeatability.h"
#include "tests/reflectance/measured/simulated_scan.h"
#include "tests/reflectance/surfaces.h"
#include "tests/reflectance/table/tables.h"

namespace gonio::reflectance::test {
namespace {

using ::testing::HasSubstr;

// The standard is the same for both, its errors too; all else is drawn anew.
const SimulatedErrors kErrors{.certificate = 0.05, .limb = 0.0, .zero_theta_r = 0.0};

// About the mirror direction, where a reading every 10 deg has been taken out.
bool in_hole(const Geometry& g) {
  return std::abs(in_degrees(g.theta_r) - 30.0) < 15.0 &&
         std::abs(in_degrees(wrapped(g.phi_r - degrees(180.0)))) < 45.0;
}

MeasuredScan scan_of(const Surface& truth, std::uint64_t seed) {
  return simulated_scan(truth, geometries({}), kErrors, seed);
}

// The second scan with the certificate's error of the first.
MeasuredScan with_one_certificate(MeasuredScan scan, double factor) {
  for (MeasuredPoint& p : scan.points) p.value = factor * p.value;
  return scan;
}

TEST(CompareScans, CountsOnlyWhatDoesNotCancel) {
  MeasuredScan a = perfect_scan(wheat(), geometries({}), 1e-3);
  MeasuredScan b = a;
  a.components = {{"certificate", "standard 7"}, {"own", ""}};
  b.components = {{"own", ""}, {"certificate", "standard 7"}};
  a.points[0].shared = {{0, per_steradian(0.04)}, {1, per_steradian(0.003)}};
  b.points[0].shared = {{0, per_steradian(0.002)}, {1, per_steradian(0.036)}};

  const ScanComparison comparison = compare_scans(a, b).value();

  // sqrt(2 u_random^2 + (0.04 - 0.036)^2 + 0.003^2 + 0.002^2).
  EXPECT_NEAR(comparison.gaps[0].u.si(), std::sqrt(2e-6 + 16e-6 + 9e-6 + 4e-6), 1e-12);
  EXPECT_NEAR(comparison.gaps[1].u.si(), std::sqrt(2e-6), 1e-12);
}

TEST(CompareScans, CountsAnErrorOfUnknownCourseAsEachPointsOwnBesideAModel) {
  MeasuredScan scan = perfect_scan(wheat(), geometries({}), 3e-4);
  scan.components = {{.name = "zero theta_r through unresolved slopes", .source = "", .is_pattern_known = false}};
  for (MeasuredPoint& p : scan.points) {
    p.shared = {{0, per_steradian(4e-4)}};
    p.value = p.value + per_steradian(1e-3);
  }

  const ScanComparison off = compare_with_surface(scan, wheat()).value();

  // Two of hypot(3e-4, 4e-4), each by itself. As one error of 4e-4 it would have explained nearly all of it away.
  EXPECT_NEAR(off.gaps[0].z, 2.0, 1e-9);
  EXPECT_NEAR(off.chi2, 4.0 * static_cast<double>(off.gaps.size()), 1e-6 * off.chi2);
}

TEST(CompareScans, FindsThatTwoScansOfOneSampleAgree) {
  const ScanComparison comparison = compare_scans(with_one_certificate(scan_of(wheat(), 11), 1.0),
                                                  with_one_certificate(scan_of(wheat(), 12), 1.0), {})
                                        .value();

  // Their certificates' errors were drawn apart, though both state the same source.
  EXPECT_LT(comparison.p_value, 1e-3);

  SimulatedErrors no_certificate = kErrors;
  no_certificate.certificate = 0.0;
  const ScanComparison same = compare_scans(simulated_scan(wheat(), geometries({}), no_certificate, 11),
                                            simulated_scan(wheat(), geometries({}), no_certificate, 12))
                                  .value();
  EXPECT_GT(same.p_value, 1e-3);
  EXPECT_NEAR(same.mean_ratio, 1.0, 2e-3);
  EXPECT_EQ(same.degrees_of_freedom, same.gaps.size());
}

TEST(CompareScans, CountsPointsWithoutAPartner) {
  const MeasuredScan a = perfect_scan(wheat(), {geometry(0, 10, 0), geometry(0, 20, 0), geometry(0, 30, 0)});
  const MeasuredScan b = perfect_scan(wheat(), {geometry(0, 20.04, 0), geometry(0, 50, 0)});

  const ScanComparison comparison = compare_scans(a, b).value();

  ASSERT_EQ(comparison.gaps.size(), 1U);
  EXPECT_EQ(comparison.gaps[0].first, 1U);
  EXPECT_EQ(comparison.gaps[0].second, 0U);
  EXPECT_EQ(comparison.unpaired_first, 2U);
  EXPECT_EQ(comparison.unpaired_second, 1U);
}

TEST(CompareScans, MeetsATurnedSampleWhereToldThatItIsIsotropic) {
  Geometry turned = geometry(30, 40, 70);
  turned.phi_i += degrees(90.0);
  turned.phi_r += degrees(90.0);
  const MeasuredScan a = perfect_scan(wheat(), {geometry(30, 40, 70)});
  const MeasuredScan b = perfect_scan(wheat(), {turned});
  const MeasuredScan mirrored = perfect_scan(wheat(), {geometry(30, 40, -70)});

  EXPECT_THAT(compare_scans(a, b).error().seen, HasSubstr("no geometry"));
  EXPECT_TRUE(compare_scans(a, b, {.sameness = Sameness::Turned}));
  EXPECT_FALSE(compare_scans(a, mirrored, {.sameness = Sameness::Turned}));
  EXPECT_TRUE(compare_scans(a, mirrored, {.sameness = Sameness::TurnedOrMirrored}));
}

TEST(CompareScans, RefusesReadingsWithoutUncertainty) {
  MeasuredScan bare = scan_of(wheat(), 1);
  bare.points[4].u_random = {};

  EXPECT_THAT(compare_scans(bare, scan_of(wheat(), 2)).error().seen, HasSubstr("point 4: u_random 0"));
  EXPECT_FALSE(compare_with_surface(bare, wheat()));
}

TEST(CompareWithSurface, HoldsForTheTruthAndNotForAnother) {
  const MeasuredScan scan = simulated_scan(wheat(), geometries({}), {}, 21);

  const ScanComparison with_truth = compare_with_surface(scan, wheat()).value();
  const ScanComparison with_other =
      compare_with_surface(scan, surface("rpv", {{"rho0", 0.133}, {"k", 0.80}, {"g", -0.114}})).value();

  EXPECT_GT(with_truth.p_value, 1e-3);
  EXPECT_EQ(with_truth.degrees_of_freedom, scan.points.size());
  EXPECT_LT(with_other.p_value, 1e-6);
  EXPECT_GT(std::abs(with_other.worst()->z), 4.0);
}

// A laboratory's table of `truth`: incidences 20 deg apart, views of 25 by 30 deg, no uncertainty told.
std::vector<TableReading> coarse_readings(const Surface& truth) {
  std::vector<TableReading> readings;
  for (const double theta_i : {10.0, 30.0, 50.0, 70.0})
    add_grid(readings, truth, direction_deg(theta_i, 0.0), {.theta_step = 25.0, .phi_step = 30.0, .last = 75.0});
  return readings;
}

MeasuredScan scan_of_readings(const std::vector<TableReading>& readings) {
  MeasuredScan scan;
  for (const TableReading& reading : readings)
    scan.points.push_back({.geometry = reading.geometry, .value = reading.f.value});
  return scan;
}

TEST(CompareWithTable, CountsWhatACoarseTableMayMissBetweenItsReadings) {
  const std::vector<TableReading> readings = coarse_readings(wheat());
  const TabulatedSurface table =
      TabulatedSurface::make(readings, {.symmetry = TableSymmetry::Turn, .widest_cell = degrees(60.0)}).value();
  const MeasuredScan scan = perfect_scan(wheat(), geometries({}), 1e-5);

  const ScanComparison told =
      compare_with_table(scan, table, scan_of_readings(readings), BetweenReadings::Uncertain).value();
  const ScanComparison exact =
      compare_with_table(scan, table, scan_of_readings(readings), BetweenReadings::Exact).value();

  EXPECT_GT(told.gaps.size(), scan.points.size() / 2) << "cells of 25 by 30 deg are compared";
  EXPECT_GT(std::abs(exact.worst()->z), 100.0) << "the table is not the wheat";
  const auto held = std::ranges::count_if(told.gaps, [](const PointGap& gap) { return std::abs(gap.z) <= 2.0; });
  EXPECT_GE(held, static_cast<long>(told.gaps.size()) * 95 / 100);
  // Nor is the doubt so large that it says nothing: wheat changes by a third of itself within such cells.
  for (const PointGap& gap : told.gaps) EXPECT_LT(gap.u, 0.2 * scan.points[gap.first].value);
}

TEST(CompareWithTable, SaysWhereTheTableEnds) {
  std::vector<TableReading> readings;
  for (const double theta_i : {30.0, 60.0})
    add_grid(readings, wheat(), direction_deg(theta_i, 0.0), {.theta_step = 10.0, .phi_step = 30.0, .last = 50.0});
  std::erase_if(readings,
                [](const TableReading& r) { return r.geometry.theta_i < degrees(45.0) && in_hole(r.geometry); });
  const TabulatedSurface table = TabulatedSurface::make(readings, {.symmetry = TableSymmetry::Turn}).value();
  const MeasuredScan scan = perfect_scan(wheat(), {geometry(30, 45, 0), geometry(70, 20, 0), geometry(45, 70, 0),
                                                   geometry(30, 65, 0), geometry(30, 30, 180)});

  const ScanComparison told =
      compare_with_table(scan, table, scan_of_readings(readings), BetweenReadings::Uncertain).value();

  EXPECT_EQ(told.gaps.size(), 1U);
  EXPECT_EQ(told.outside.beyond_incidences, 1U);
  EXPECT_EQ(told.outside.beyond_views, 2U);
  EXPECT_EQ(told.outside.in_holes, 1U);
  EXPECT_EQ(told.unpaired_first, 4U);
}

TEST(ScanSymmetry, IsCheckedByTheScansOwnSharedParts) {
  MeasuredScan scan = simulated_scan(wheat(), geometries({}), {}, 31);
  const ScanSymmetryPoints points = symmetry_points(scan);

  const SymmetryReport report =
      check_symmetry(Symmetry::Reciprocity, points.points, {.sameness = Sameness::TurnedOrMirrored}).value();

  EXPECT_GT(report.gaps.size(), 20U);
  EXPECT_GT(report.p_value, 1e-3);
}

TEST(Repeatability, TellsScatterAndTheScanThatStandsOut) {
  SimulatedErrors errors;
  errors.certificate = errors.limb = errors.zero_theta_r = errors.background = 0.0;
  std::vector<MeasuredScan> scans;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    scans.push_back(simulated_scan(wheat(), geometries({}), errors, seed));
    scans.back().components.clear();
    for (MeasuredPoint& p : scans.back().points) p.shared.clear();
  }
  const Repeatability good = repeatability(scans).value();
  scans[3] = with_one_certificate(scans[3], 1.02);
  const Repeatability bad = repeatability(scans).value();

  EXPECT_NEAR(good.relative_scatter, errors.noise, 0.1 * errors.noise);
  EXPECT_GT(good.p_value, 1e-3);
  EXPECT_EQ(good.points.front().count, 5U);
  EXPECT_LT(bad.p_value, 1e-6);
  EXPECT_NEAR(bad.scans[3].mean_offset, 0.02 * 0.8, 2e-3);
  EXPECT_NEAR(bad.scans[0].mean_offset, -0.02 * 0.2, 2e-3);
}

TEST(Repeatability, NeedsTwoScansWithAGeometryInCommon) {
  const std::vector<MeasuredScan> one{perfect_scan(wheat(), {geometry(0, 10, 0)})};
  const std::vector<MeasuredScan> apart{one[0], perfect_scan(wheat(), {geometry(0, 20, 0)})};

  EXPECT_EQ(repeatability(one).error().seen, "1 scans");
  EXPECT_THAT(repeatability(apart).error().seen, HasSubstr("no geometry"));
}

}  // namespace
}  // namespace gonio::reflectance::test
