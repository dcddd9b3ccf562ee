// Readings of a radiometer in the measurement equation. Expected values by hand, from the numbers in the comments.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/calibrate.h"
#include "tests/calibration/reference_text.h"
#include "tests/calibration/scan_builder.h"

namespace gonio::calibration {
namespace {

using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;
constexpr double kDarkW = 1e-7;
const UtcTime kToday{std::chrono::sys_days{std::chrono::year{2026} / 3 / 1}};

// One average scatters by 1e-4 of 1e-4 W; ten samples of two averages: 1e-8 / sqrt(20) W.
constexpr double kNoiseW = 2.2360679774997897e-9;

RawFrame frame(double watts, double monitor, double range_w) {
  const Geometry g = directions(30.0, 40.0, 60.0);
  return {.monitor_mean = monitor,
          .monitor_se = 1e-3 * monitor,
          .at_open = g,
          .at_close = g,
          .power =
              PowerReading{.mean_w = watts, .standard_error_w = 1.0, .samples = 10, .averages = 2, .range_w = range_w}};
}

RawReading reading(std::int64_t id, Target target, double at_s, RawFrame frame) {
  return {.id = id,
          .target = target,
          .point_index = target == Target::Dark ? std::nullopt : std::optional<std::int32_t>(0),
          .visit_id = id,
          .wavelength = nanometres(568.0),
          .at = ScanBuilder::at(at_s),
          .frames = {std::move(frame)}};
}

// 20 uW at lamp 1 mW and 80 uW at lamp 2 mW: q = 0.02 and 0.04, so f = 0.99 / pi / 2.
ScanReadings half_as_bright(double reference_range_w = 1e-4) {
  ScanReadings scan;
  scan.points = {{.index = 0, .geometry = directions(30.0, 40.0, 60.0), .wavelength = nanometres(568.0)}};
  RawReading dark = reading(1, Target::Dark, 0.0, frame(kDarkW, 1e-3, 1e-4));
  dark.frames.push_back(frame(kDarkW, 1e-3, 1e-3));
  scan.readings = {dark, reading(2, Target::Sample, 10.0, frame(2e-5 + kDarkW, 1e-3, 1e-4)),
                   reading(3, Target::Reference, 20.0, frame(8e-5 + kDarkW, 2e-3, reference_range_w))};
  return scan;
}

InstrumentModel meter(PowerModel power = {.noise = 1e-4}) {
  return {.detector = {.full_scale_dn = 1.0, .power = power}};
}

CalibratedScan calibrated(const ScanReadings& scan, const InstrumentModel& instrument) {
  auto standard = ReferenceStandard::parse(ReferenceText{}.text(), "white.toml");
  EXPECT_TRUE(standard) << describe(standard.error());
  auto result = calibrate(scan, instrument, *standard, kToday);
  EXPECT_TRUE(result) << describe(result.error());
  return std::move(result).value();
}

double term(const CalibratedScan& scan, std::string_view name) {
  const Budget& budget = scan.points.at(0).budget;
  for (const auto* terms : {&budget.random, &budget.shared}) {
    for (const BudgetTerm& t : *terms) {
      if (scan.components[t.component].name == name) return t.per_sd.si();
    }
  }
  return 0.0;
}

constexpr double kF = 0.99 / kPi * 0.5;

TEST(PowerReadingTest, GivesTheHandComputedBrdf) {
  const CalibratedScan scan = calibrated(half_as_bright(), meter());

  ASSERT_EQ(scan.points.size(), 1U);
  EXPECT_NEAR(scan.points[0].value.si(), kF, 1e-13);
}

TEST(PowerReadingTest, HasTheNoiseOfTheMeterInItsRangeNotTheScatterOfAHandfulOfSamples) {
  const CalibratedScan scan = calibrated(half_as_bright(), meter());

  EXPECT_NEAR(term(scan, "noise of the sample reading"), kF * kNoiseW / 2e-5, 1e-14);
  EXPECT_NEAR(term(scan, "noise of the reference reading"), kF * kNoiseW / 8e-5, 1e-14);
}

TEST(PowerReadingTest, HasTenTimesTheNoiseInTenTimesTheRange) {
  const CalibratedScan scan = calibrated(half_as_bright(1e-3), meter());

  EXPECT_NEAR(term(scan, "noise of the reference reading"), kF * 10.0 * kNoiseW / 8e-5, 1e-13);
}

TEST(PowerReadingTest, AddsWhatTheMonitorDoesNotSeeOfTheSameWindowToItsNoise) {
  InstrumentModel instrument = meter();
  instrument.detector.u_monitor_window = 2e-3;

  const CalibratedScan scan = calibrated(half_as_bright(), instrument);

  EXPECT_NEAR(term(scan, "monitor noise of the sample reading"), kF * std::sqrt(5.0) * 1e-3, 1e-12);
}

TEST(PowerReadingTest, SharesOneDarkBetweenSampleAndReferenceWhichPartlyCancels) {
  const CalibratedScan scan = calibrated(half_as_bright(), meter());

  // d f/f = -u (1/20 uW - 1/80 uW)
  EXPECT_NEAR(std::abs(term(scan, "dark visit 1 in the range of 0.0001 W")), kF * kNoiseW * 37500.0, 1e-13);
}

TEST(PowerReadingTest, LosesTheRangesGainsBetweenReadingsInOneRange) {
  const InstrumentModel instrument = meter({.noise = 1e-4, .u_range = 1e-3});

  const CalibratedScan same = calibrated(half_as_bright(), instrument);
  const CalibratedScan other = calibrated(half_as_bright(1e-3), instrument);

  EXPECT_EQ(term(same, "gain of the range of 0.0001 W"), 0.0);
  EXPECT_NEAR(term(other, "gain of the range of 0.0001 W"), kF * 1e-3, 1e-13);
  EXPECT_NEAR(term(other, "gain of the range of 0.001 W"), -kF * 1e-3, 1e-13);
}

TEST(PowerReadingTest, HasALinearityThatGrowsWithThePartOfTheRange) {
  InstrumentModel instrument = meter();
  instrument.detector.u_linearity = 1e-3;

  // 0.2 and 0.8 of the range: -0.6 of u.
  EXPECT_NEAR(term(calibrated(half_as_bright(), instrument), "linearity"), -0.6 * kF * 1e-3, 1e-12);
  // 0.2 and 0.08
  EXPECT_NEAR(term(calibrated(half_as_bright(1e-3), instrument), "linearity"), 0.12 * kF * 1e-3, 1e-12);
}

TEST(PowerReadingTest, HasAZeroThatMayWanderBetweenDarks) {
  const InstrumentModel instrument = meter({.noise = 1e-4, .u_zero = 1e-4});

  // 1e-4 of 1e-4 W, twice as much beyond the only dark (dark_history.h), and as the dark's own noise cancels in part.
  EXPECT_NEAR(std::abs(term(calibrated(half_as_bright(), instrument), "zero 1 to -1 in the range of 0.0001 W")),
              kF * 2.0 * 1e-8 * 37500.0, 1e-12);
}

TEST(PowerReadingTest, IsRefusedWithoutADarkInItsRange) {
  const CalibratedScan scan = calibrated(half_as_bright(1e-2), meter());

  ASSERT_EQ(scan.refused.size(), 1U);
  EXPECT_EQ(scan.refused[0].reason.code, ErrorCode::IncompleteData);
  EXPECT_THAT(describe(scan.refused[0].reason), HasSubstr("range of 0.01 W"));
}

TEST(PowerReadingTest, IsRefusedWithoutLightOnTheMonitor) {
  ScanReadings readings = half_as_bright();
  readings.readings[1].frames[0].monitor_mean = 0.0;

  const CalibratedScan scan = calibrated(readings, meter());

  ASSERT_EQ(scan.refused.size(), 1U);
  EXPECT_EQ(scan.refused[0].reason.code, ErrorCode::IncompleteData);
}

}  // namespace
}  // namespace gonio::calibration
