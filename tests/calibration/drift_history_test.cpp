// What visits of the standard take out of the BRDF, and what they leave in its budget.
#include "calibration/drift_history.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/calibrate.h"
#include "tests/calibration/reference_text.h"
#include "tests/calibration/scan_builder.h"

namespace gonio::calibration {
namespace {

const UtcTime kToday{std::chrono::sys_days{std::chrono::year{2026} / 3 / 1}};
constexpr double kF = 0.99 / std::numbers::pi * 0.5;

ReferenceStandard white() {
  auto parsed = ReferenceStandard::parse(ReferenceText{}.text(), "white.toml");
  EXPECT_TRUE(parsed) << describe(parsed.error());
  return std::move(parsed).value();
}

InstrumentModel quiet() {
  return {.detector = {.electrons_per_dn = 1e6, .read_noise_dn = 0.0}, .lamp = {.u_reproducibility = 1e-3}};
}

// A response of 1 at 0 s and 0.96 at 400 s; the sample read at 100 s (0.99), its reference at 300 s (0.97).
ScanBuilder drifting() {
  ScanBuilder builder({0.01});
  const auto point = builder.add_point(directions(0.0, 45.0, 90.0));
  const auto visit = [&](double at_s, double net_dn) {
    RawReading& reading = builder.add_item(Target::Reference, point, at_s, 0.01, net_dn);
    reading.visited_point = reading.point_index;
    reading.point_index.reset();
  };
  builder.add_dark(-10.0);
  visit(0.0, 2000.0);
  builder.add_item(Target::Sample, point, 100.0, 0.01, 0.5 * 0.99 * 2000.0);
  builder.add_item(Target::Reference, point, 300.0, 0.01, 0.97 * 2000.0);
  visit(400.0, 0.96 * 2000.0);
  builder.add_dark(410.0);
  return builder;
}

CalibratedScan calibrated(const ScanReadings& scan, bool correct_drift = true) {
  auto result = calibrate(scan, quiet(), white(), kToday, {.correct_drift = correct_drift});
  EXPECT_TRUE(result) << describe(result.error());
  return std::move(result).value();
}

// Root sum of squares of all terms of the first point whose names begin so.
double all_of(const CalibratedScan& scan, std::string_view start) {
  double squares = 0.0;
  for (const auto* terms : {&scan.points.at(0).budget.random, &scan.points.at(0).budget.shared}) {
    for (const BudgetTerm& t : *terms) {
      if (scan.components[t.component].name.starts_with(start)) squares += t.per_sd.si() * t.per_sd.si();
    }
  }
  return std::sqrt(squares);
}

double shared(const CalibratedScan& scan, std::string_view name) {
  for (const BudgetTerm& t : scan.points.at(0).budget.shared) {
    if (scan.components[t.component].name == name) return t.per_sd.si();
  }
  return 0.0;
}

TEST(Drift, IsTakenOutByTheVisitsOnBothSides) {
  EXPECT_NEAR(calibrated(drifting().scan()).points[0].value.si(), kF, 1e-12);
  EXPECT_NEAR(calibrated(drifting().scan(), false).points[0].value.si(), kF * 0.99 / 0.97, 1e-12);
}

TEST(Drift, PutsEachVisitIntoTheBudgetByTheDifferenceOfItsWeights) {
  const CalibratedScan scan = calibrated(drifting().scan());

  // Weights of the first visit 0.75 at the sample and 0.25 at the reference; of the second the other way round.
  const double first = kF * (0.25 / 0.97 - 0.75 / 0.99);
  const double second = kF * (0.75 / 0.97 - 0.25 / 0.99);
  EXPECT_NEAR(shared(scan, "reference visit 2"), first * 1e-3, std::abs(first) * 1e-4);
  EXPECT_NEAR(shared(scan, "reference visit 5"), second * 0.96e-3, std::abs(second) * 1e-4);
}

TEST(Drift, AllowsForAStepAtAnyMomentBetweenTheVisits) {
  const CalibratedScan scan = calibrated(drifting().scan());

  // Half of the interval lies between the two readings: 0.04 * sqrt(0.5 * 0.5), less what the visits' own u explains.
  EXPECT_NEAR(all_of(scan, "drift"), kF * 0.04 * 0.5 / 0.99, kF * 1e-4);
  EXPECT_NEAR(all_of(scan, "drift between visits 2 and 5, course 2"),
              kF * 0.04 * std::sqrt(2.0) / std::numbers::pi / 0.99, kF * 1e-4)
      << "sin(2 pi p) at 3/4 less that at 1/4, over 2 pi";
}

TEST(Drift, FlagsAPointBetweenVisitsBeyondThePlansLimit) {
  ScanBuilder builder = drifting();

  EXPECT_FALSE(has(calibrated(builder.scan()).points[0].flags, PointFlag::Drifted)) << "the plan states no limit";
  builder.scan().drift_limit = 0.05;
  EXPECT_FALSE(has(calibrated(builder.scan()).points[0].flags, PointFlag::Drifted));
  builder.scan().drift_limit = 0.03;
  EXPECT_TRUE(has(calibrated(builder.scan()).points[0].flags, PointFlag::Drifted));
}

TEST(Drift, OfASingleVisitIsNotKnown) {
  ScanBuilder builder = drifting();
  std::erase_if(builder.scan().readings, [](const RawReading& r) { return r.visited_point && r.visit_id == 5; });

  EXPECT_NEAR(calibrated(builder.scan()).points[0].value.si(), kF * 0.99 / 0.97, 1e-12);
}

TEST(Drift, BeyondTheLastVisitStaysAndWidens) {
  ScanBuilder builder = drifting();
  const auto point = builder.add_point(directions(0.0, 45.0, 60.0));
  builder.add_item(Target::Sample, point, 600.0, 0.01, 500.0);
  builder.add_item(Target::Reference, point, 800.0, 0.01, 1000.0);
  std::ranges::stable_sort(builder.scan().readings, {}, &RawReading::at);
  const CalibratedScan scan = calibrated(builder.scan());

  ASSERT_EQ(scan.points.size(), 2U);
  EXPECT_NEAR(scan.points[1].value.si(), kF, 1e-12);
  bool is_widened = false;
  for (const BudgetTerm& t : scan.points[1].budget.shared) {
    if (scan.components[t.component].name != "drift between visits 5 and -1") continue;
    is_widened = true;
    EXPECT_NEAR(t.per_sd.si(), kF * 0.04 * 0.5 / 0.96, kF * 1e-4) << "half an interval apart";
  }
  EXPECT_TRUE(is_widened);
}

}  // namespace
}  // namespace gonio::calibration
