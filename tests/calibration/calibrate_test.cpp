#include "calibration/calibrate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/calibration/reference_text.h"
#include "tests/calibration/scan_builder.h"

namespace gonio::calibration {
namespace {

constexpr double kPi = std::numbers::pi;
const UtcTime kToday{std::chrono::sys_days{std::chrono::year{2026} / 3 / 1}};

ReferenceStandard white(const ReferenceText& text = {}) {
  auto parsed = ReferenceStandard::parse(text.text(), "white.toml");
  EXPECT_TRUE(parsed) << describe(parsed.error());
  return std::move(parsed).value();
}

CalibratedScan calibrated(const ScanReadings& scan, const InstrumentModel& instrument,
                          const ReferenceStandard& standard = white()) {
  auto result = calibrate(scan, instrument, standard, kToday);
  EXPECT_TRUE(result) << describe(result.error());
  return std::move(result).value();
}

Brdf term(const CalibratedScan& scan, const Budget& budget, std::string_view name) {
  for (const auto* terms : {&budget.random, &budget.shared}) {
    for (const BudgetTerm& t : *terms) {
      if (scan.components[t.component].name == name) return t.per_sd;
    }
  }
  return {};
}

InstrumentModel quiet() {
  return {.detector = {.electrons_per_dn = 4.0, .read_noise_dn = 2.0}};
}

// Two frames, 1000 DN in 20 ms at lamp 1 and 2000 DN in 10 ms at lamp 2: q = 50000 and 100000.
ScanBuilder half_as_bright() {
  ScanBuilder scan({0.02, 0.01});
  const auto point = scan.add_point(directions(30.0, 40.0, 60.0));
  scan.add_dark(0.0);
  scan.add_item(Target::Sample, point, 10.0, 0.02, 1000.0, 1.0);
  scan.add_item(Target::Reference, point, 30.0, 0.01, 2000.0, 2.0);
  scan.add_dark(40.0);
  return scan;
}

TEST(Calibrate, GivesTheHandComputedBrdfOfALambertianSample) {
  const CalibratedScan scan = calibrated(half_as_bright().scan(), quiet());

  ASSERT_EQ(scan.points.size(), 1U);
  EXPECT_NEAR(scan.points[0].value.si(), 0.99 / kPi * 0.5, 1e-15);
  EXPECT_EQ(scan.points[0].geometry, directions(30.0, 40.0, 60.0));
  EXPECT_TRUE(scan.refused.empty());
}

TEST(Calibrate, GivesTheHandComputedBudgetOfALambertianSample) {
  const CalibratedScan scan = calibrated(half_as_bright().scan(), quiet());

  // Pixel variance: 2^2 + net / 4, over 100 pixels of one frame. Dark level: 2^2 / 100, both visits.
  const double f = 0.99 / kPi * 0.5;
  const Budget& budget = scan.points.at(0).budget;
  const double noise_sample = f * std::sqrt((4.0 + 250.0) / 100.0) / 1000.0;
  const double noise_reference = f * std::sqrt((4.0 + 500.0) / 100.0) / 2000.0;
  const double certificate = f * 0.003 / 0.99;
  const double integral = f * 0.001;
  EXPECT_NEAR(term(scan, budget, "noise of the sample reading").si(), noise_sample, 1e-15);
  EXPECT_NEAR(term(scan, budget, "noise of the reference reading").si(), noise_reference, 1e-15);
  EXPECT_NEAR(term(scan, budget, "certificate").si(), certificate, 1e-15);
  EXPECT_NEAR(term(scan, budget, "shape integral").si(), integral, 1e-15);
  // At 10 s of 40 s three quarters of the first dark, at 30 s one quarter; 0.2 DN each.
  EXPECT_NEAR(term(scan, budget, "dark visit 1 at 20000 us").si(), -f * 0.75 * 0.2 / 1000.0, 1e-15);
  EXPECT_NEAR(term(scan, budget, "dark visit 4 at 20000 us").si(), -f * 0.25 * 0.2 / 1000.0, 1e-15);
  EXPECT_NEAR(term(scan, budget, "dark visit 1 at 10000 us").si(), f * 0.25 * 0.2 / 2000.0, 1e-15);
  const double random2 = std::pow(noise_sample, 2) + std::pow(noise_reference, 2);
  const double darks2 = (0.75 * 0.75 + 0.25 * 0.25) * (std::pow(f * 0.2 / 1000.0, 2) + std::pow(f * 0.2 / 2000.0, 2));
  EXPECT_NEAR(budget.u_random.si(), std::sqrt(random2), 1e-15);
  EXPECT_NEAR(budget.u.si(), std::sqrt(random2 + darks2 + certificate * certificate + integral * integral), 1e-15);
  EXPECT_NEAR(budget.expanded.si(), 2.0 * budget.u.si(), 1e-15);
}

TEST(Calibrate, KeepsTheSignOfASignalBelowTheDark) {
  ScanBuilder builder = half_as_bright();
  builder.scan().readings[1].frames[0].region.mean = ScanBuilder::kDarkDn - 0.1;

  const CalibratedScan scan = calibrated(builder.scan(), quiet());

  ASSERT_EQ(scan.points.size(), 1U);
  EXPECT_NEAR(scan.points[0].value.si(), -0.99 / kPi * 0.5 * 1e-4, 1e-15);
  EXPECT_TRUE(has(scan.points[0].flags, PointFlag::NearZero));
  EXPECT_GT(scan.points[0].budget.u.si(), 0.99 / kPi * 0.5 * 0.2 / 1000.0);  // the frame's noise alone
  EXPECT_EQ(scan.summary.near_zero, 1U);
}

TEST(Calibrate, InterpolatesTheDarkInTimeBetweenTheVisitsOfTheSameExposure) {
  ScanBuilder builder = half_as_bright();
  for (RawFrame& frame : builder.scan().readings[3].frames) frame.region.mean += 8.0;  // the dark rises 8 DN in 40 s

  const CalibratedScan scan = calibrated(builder.scan(), quiet());

  EXPECT_NEAR(scan.points.at(0).value.si(), 0.99 / kPi * (998.0 / 0.02) / (1994.0 / 0.02), 1e-15);
  EXPECT_FALSE(has(scan.points[0].flags, PointFlag::DarkExtrapolated));
}

TEST(Calibrate, TakesTheNearestDarkOutsideAndWidensItsDrift) {
  InstrumentModel instrument = quiet();
  instrument.detector.u_dark_drift_dn_per_s = 10.0;
  ScanBuilder inside = half_as_bright();
  ScanBuilder outside = half_as_bright();
  outside.scan().readings[3].at = ScanBuilder::at(-40.0);
  std::ranges::rotate(outside.scan().readings, outside.scan().readings.end() - 1);

  const CalibratedScan bracketed = calibrated(inside.scan(), instrument);
  const CalibratedScan extrapolated = calibrated(outside.scan(), instrument);

  // 10 s and 30 s after the last of two darks 40 s apart: 2 sqrt(10/40) = 1 and 2 sqrt(30/40) times the stated drift.
  const double f = 0.99 / kPi * 0.5;
  const double sample = -f * 10.0 * 0.02 / 1000.0;
  const double reference = f * 10.0 * 0.01 / 2000.0;
  EXPECT_NEAR(term(bracketed, bracketed.points.at(0).budget, "dark drift 1 to 4").si(), sample + reference, 1e-15);
  EXPECT_NEAR(term(extrapolated, extrapolated.points.at(0).budget, "dark drift 1 to -1").si(),
              sample + reference * 2.0 * std::sqrt(0.75), 1e-15);
  EXPECT_TRUE(has(extrapolated.points[0].flags, PointFlag::DarkExtrapolated));
}

TEST(Calibrate, LetsAFullySharedDriftOfTheDarkCancelWhereTheReadingsAreAlike) {
  InstrumentModel instrument = quiet();
  instrument.detector.u_dark_drift_dn_per_s = 10.0;
  ScanBuilder builder({0.02});
  const auto point = builder.add_point(directions(0.0, 45.0, 0.0));
  builder.add_dark(0.0);
  builder.add_item(Target::Sample, point, 10.0, 0.02, 1000.0);
  builder.add_item(Target::Reference, point, 10.0, 0.02, 1000.0);
  builder.add_dark(20.0);

  const CalibratedScan scan = calibrated(builder.scan(), instrument);

  EXPECT_EQ(term(scan, scan.points.at(0).budget, "dark drift 1 to 4"), Brdf{});
}

TEST(Calibrate, CombinesFramesOfDifferentExposuresAsTheirLight) {
  ScanBuilder builder = half_as_bright();
  RawReading& sample = builder.scan().readings[1];
  sample.frames.push_back(sample.frames[0]);
  sample.frames[1].exposure_s = 0.01;
  sample.frames[1].region.mean = ScanBuilder::kDarkDn + 560.0;  // q = 56000

  const CalibratedScan scan = calibrated(builder.scan(), quiet());

  EXPECT_NEAR(scan.points.at(0).value.si(), 0.99 / kPi * (1560.0 / 0.03) / 1e5, 1e-15);
}

TEST(Calibrate, CountsTheExposureOffsetAndTheGain) {
  InstrumentModel instrument = quiet();
  instrument.detector.exposure_offset_s.value = 0.005;
  ScanBuilder builder = half_as_bright();
  for (RawReading* reading : {&builder.scan().readings[0], &builder.scan().readings[2], &builder.scan().readings[3]}) {
    reading->frames.push_back(reading->frames.back());
    reading->frames.back().gain_db = 20.0;
  }
  builder.scan().readings[2].frames.erase(builder.scan().readings[2].frames.begin());

  const CalibratedScan scan = calibrated(builder.scan(), instrument);

  ASSERT_EQ(scan.points.size(), 1U) << describe(scan.refused.at(0).reason);
  EXPECT_NEAR(scan.points[0].value.si(), 0.99 / kPi * (1000.0 / 0.025) / (2000.0 / (0.015 * 10.0 * 2.0)), 1e-13);
}

TEST(Calibrate, CorrectsTheCosineWhereSampleAndReferenceStoodAtSlightlyDifferentAngles) {
  ScanBuilder builder = half_as_bright();
  RawFrame& frame = builder.scan().readings[1].frames[0];
  frame.at_open.theta_i = frame.at_close.theta_i = degrees(30.01);

  const CalibratedScan scan = calibrated(builder.scan(), quiet());

  const double ratio = std::cos(30.0 * kPi / 180.0) / std::cos(30.01 * kPi / 180.0);
  EXPECT_NEAR(scan.points.at(0).value.si(), 0.99 / kPi * 0.5 * ratio, 1e-14);
  EXPECT_NEAR(in_degrees(scan.points[0].geometry.theta_i), 30.01, 1e-12);
}

TEST(Calibrate, MakesAReferenceReadingThatServesTwoPointsOneSharedError) {
  ScanBuilder builder({0.02});
  const auto left = builder.add_point(directions(30.0, 40.0, 60.0));
  const auto right = builder.add_point(directions(30.0, 40.0, -60.0));
  builder.scan().isotropic = false;
  builder.add_dark(0.0);
  builder.add_item(Target::Sample, left, 10.0, 0.02, 1000.0);
  builder.add_item(Target::Sample, right, 20.0, 0.02, 2000.0);
  builder.add_item(Target::Reference, left, 30.0, 0.02, 2000.0);
  builder.add_dark(40.0);

  const CalibratedScan scan = calibrated(builder.scan(), quiet());

  ASSERT_EQ(scan.points.size(), 2U);
  const double relative = std::sqrt((4.0 + 500.0) / 100.0) / 2000.0;
  for (const CalibratedPoint& point : scan.points) {
    EXPECT_NEAR(term(scan, point.budget, "reference reading 4").si(), -point.value.si() * relative, 1e-15);
    EXPECT_EQ(term(scan, point.budget, "noise of the reference reading"), Brdf{});
  }
  EXPECT_FALSE(has(scan.points[0].flags, PointFlag::BorrowedReference));
  EXPECT_TRUE(has(scan.points[1].flags, PointFlag::BorrowedReference));
}

TEST(Calibrate, ListsPointsThatCannotBeUsedWithTheReasonAndNeverFillsThemIn) {
  ScanBuilder builder({0.02});
  for (const double theta_r : {10.0, 20.0, 30.0, 40.0, 50.0}) builder.add_point(directions(0.0, theta_r, 0.0));
  builder.add_dark(0.0);
  builder.add_item(Target::Sample, 0, 10.0, 0.02, 1000.0).frames[0].region.saturated = 1;
  builder.add_item(Target::Reference, 0, 11.0, 0.02, 1000.0);
  builder.add_item(Target::Sample, 1, 12.0, 0.02, 1000.0);  // no reference
  builder.add_item(Target::Sample, 2, 13.0, 0.04, 1000.0);  // no dark at 40 ms
  builder.add_item(Target::Reference, 2, 14.0, 0.02, 1000.0);
  builder.add_item(Target::Sample, 3, 15.0, 0.02, 1000.0);
  builder.add_item(Target::Reference, 3, 16.0, 0.02, -1.0);  // no light on the reference

  const CalibratedScan scan = calibrated(builder.scan(), quiet());

  EXPECT_TRUE(scan.points.empty());
  ASSERT_EQ(scan.refused.size(), 4U);  // point 4 has not been measured: it is neither
  EXPECT_EQ(scan.refused[0].reason.code, ErrorCode::Saturated);
  EXPECT_EQ(scan.refused[1].reason.code, ErrorCode::IncompleteData);
  EXPECT_EQ(scan.refused[2].reason.code, ErrorCode::IncompleteData);
  EXPECT_EQ(scan.refused[3].reason.code, ErrorCode::IncompleteData);
  EXPECT_EQ(scan.refused[3].point_index, 3);
}

TEST(Calibrate, RefusesAnExpiredCertificateAndNamesItsLine) {
  const auto late = UtcTime(std::chrono::sys_days{std::chrono::year{2027} / 11 / 4});

  const auto refused = calibrate(half_as_bright().scan(), quiet(), white(), late);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::ReferenceExpired);
  EXPECT_EQ(refused.error().where->file, "white.toml");
}

TEST(Calibrate, RefusesAPointWhoseWavelengthTheCertificateLacks) {
  ScanBuilder builder({0.02});
  const auto point = builder.add_point(directions(0.0, 45.0, 0.0), nanometres(632.8));
  builder.add_dark(0.0);
  builder.add_item(Target::Sample, point, 10.0, 0.02, 1000.0);
  builder.add_item(Target::Reference, point, 20.0, 0.02, 1000.0);

  const CalibratedScan scan = calibrated(builder.scan(), quiet());

  ASSERT_EQ(scan.refused.size(), 1U);
  EXPECT_EQ(scan.refused[0].reason.code, ErrorCode::ReferenceOutOfReach);
}

TEST(Calibrate, GivesTheSameBitsForTheSameInputs) {
  const CalibratedScan once = calibrated(half_as_bright().scan(), quiet());
  const CalibratedScan again = calibrated(half_as_bright().scan(), quiet());

  EXPECT_EQ(once.points[0].value, again.points[0].value);
  EXPECT_TRUE(std::ranges::equal(once.points[0].budget.shared, again.points[0].budget.shared));
  EXPECT_EQ(once.summary, again.summary);
  EXPECT_EQ(describe_inputs(quiet(), white()), describe_inputs(quiet(), white()));
}

TEST(Calibrate, NamesItsInputsSoThatAnyChangedNumberShows) {
  InstrumentModel other = quiet();
  other.angles.u_zero_phi_r = degrees(1e-9);
  ReferenceText text;
  text.shape_extra = "u_integral = 0.001000001\n";

  EXPECT_NE(describe_inputs(quiet(), white()), describe_inputs(other, white()));
  EXPECT_NE(describe_inputs(quiet(), white()), describe_inputs(quiet(), white(text)));
}

}  // namespace
}  // namespace gonio::calibration
