// Monte Carlo beside the formula; k of errors with bounds; threads; what cancels between two scans.
#include "calibration/monte_carlo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "calibration/calibrate.h"
#include "calibration/coverage_interval.h"
#include "calibration/scan_comparison.h"
#include "tests/calibration/reference_text.h"
#include "tests/calibration/scan_builder.h"

namespace gonio::calibration {
namespace {

const UtcTime kToday{std::chrono::sys_days{std::chrono::year{2026} / 3 / 1}};

CalibratedScan calibrated(const ScanReadings& scan, const InstrumentModel& instrument,
                          const CalibrationOptions& options = {}) {
  const auto standard = ReferenceStandard::parse(ReferenceText{}.text(), "white.toml");
  EXPECT_TRUE(standard);
  auto result = calibrate(scan, instrument, *standard, kToday, options);
  EXPECT_TRUE(result) << describe(result.error());
  return std::move(result).value();
}

InstrumentModel ordinary() {
  return {.detector = {.electrons_per_dn = 4.0, .read_noise_dn = 1.5, .u_linearity = 0.002},
          .angles = {.u_zero_theta_i = degrees(0.02), .u_zero_theta_r = degrees(0.02), .u_zero_phi_r = degrees(0.02)},
          .lamp = {.u_after_monitor = 0.001, .u_reproducibility = 0.002},
          .version = "7"};
}

// A grid of many points, so that it has several blocks.
ScanReadings many(int points, double reference_dn = 2000.0) {
  ScanBuilder builder({0.02, 0.01});
  builder.add_dark(0.0);
  for (int n = 0; n < points; ++n) {
    const Geometry g = directions(10.0 + 2.0 * (n % 30), 5.0 + 2.0 * ((n / 30) % 35), 2.0 * (n / 1050));
    const auto point = builder.add_point(g);
    builder.add_item(Target::Sample, point, n + 1.0, 0.02, 900.0 + n % 7);
    builder.add_item(Target::Reference, point, n + 1.5, 0.01, reference_dn);
  }
  builder.add_dark(points + 10.0);
  return builder.scan();
}

TEST(MonteCarlo, AgreesWithTheFormulaWithinThreePercentWhereThatHolds) {
  const ScanReadings scan = many(12);
  const CalibratedScan formula = calibrated(scan, ordinary(), {.monte_carlo = MonteCarloUse::Never});
  const CalibratedScan drawn = calibrated(scan, ordinary(), {.monte_carlo = MonteCarloUse::Always});

  for (std::size_t n = 0; n < formula.points.size(); ++n) {
    const Budget& a = formula.points[n].budget;
    const Budget& b = drawn.points[n].budget;
    EXPECT_EQ(b.method, BudgetMethod::MonteCarlo);
    EXPECT_NEAR(b.u / a.u, 1.0, 0.03);
    EXPECT_NEAR(0.5 * (b.below + b.above).si() / a.expanded.si(), 1.0, 0.03);
  }
}

TEST(MonteCarlo, IsNotAskedForOnAnOrdinaryPointAndChosenByItselfForAnUncertainDivisor) {
  EXPECT_EQ(calibrated(many(4), ordinary()).points[0].budget.method, BudgetMethod::Formula);

  const CalibratedScan faint = calibrated(many(4, 1.0), ordinary());

  const CalibratedPoint& point = faint.points[0];
  EXPECT_EQ(point.budget.method, BudgetMethod::MonteCarlo);
  EXPECT_TRUE(has(point.flags, PointFlag::MonteCarlo));
  EXPECT_GT(point.budget.above, point.budget.below) << "one over a normal leans upwards";
}

TEST(MonteCarlo, OfTheSameSeedHasTheSameBits) {
  const ScanReadings scan = many(5);
  const CalibrationOptions always{.monte_carlo = MonteCarloUse::Always, .seed = 5};

  const CalibratedScan a = calibrated(scan, ordinary(), always);
  const CalibratedScan b = calibrated(scan, ordinary(), always);

  for (std::size_t n = 0; n < a.points.size(); ++n) EXPECT_EQ(a.points[n].budget.above, b.points[n].budget.above);
}

// Of |R| for a rectangle of half width 1: 0.9545; its u is 1 / sqrt(3).
TEST(CoverageInterval, OfARectangleAloneEndsShortOfItsEdgeAndOfANormalIsTwo) {
  EXPECT_NEAR(coverage_factor_with_rectangle(1e6), 0.9545 * std::numbers::sqrt3, 1e-12);
  EXPECT_EQ(coverage_factor_with_rectangle(0.0), 2.0);
  EXPECT_LT(coverage_factor_with_rectangle(2.0), 2.0);
}

// The cosine of any angle: P(|X| <= x) = 2/pi asin(x / amplitude). The series' least normal part makes k larger by less
// than 0.5 %.
TEST(CoverageInterval, OfAnAngleThatNobodyKnowsEndsAtItsAmplitude) {
  const double alone = std::numbers::sqrt2 * std::sin(0.5 * std::numbers::pi * 0.9545);

  EXPECT_NEAR(coverage_factor_with_bounds(0.0, 0.0, std::array{1.0}), 1.0025 * alone, 0.0025 * alone);
  EXPECT_EQ(coverage_factor_with_bounds(1.0, 0.5, std::array{0.0}), coverage_factor_with_rectangle(0.5));
  EXPECT_NEAR(coverage_factor_with_bounds(1.0, 0.0, std::array{1e-3}), 2.0, 1e-4);
}

// Against draws of the sum itself.
TEST(CoverageInterval, OfNormalRectangleAndAnglesTogetherHoldsTheShareThatItSays) {
  constexpr std::uint64_t kSeed = 11;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  std::mt19937_64 engine(kSeed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> even(-1.0, 1.0);
  constexpr int kDraws = 400'000;
  for (const auto& [n, r, a, b] : {std::array{1.0, 0.0, 1.0, 0.0}, std::array{0.5, 0.0, 1.0, 1.0},
                                   std::array{0.3, 1.0, 0.7, 0.2}, std::array{0.1, 0.0, 1.0, 0.1}}) {
    const double k = coverage_factor_with_bounds(n, r, std::array{a, b});
    const double reach = k * std::sqrt(n * n + r * r + a * a + b * b);
    int held = 0;
    for (int draw = 0; draw < kDraws; ++draw) {
      const double x = n * normal(engine) + std::numbers::sqrt3 * r * even(engine) +
                       std::numbers::sqrt2 * (a * std::cos(std::numbers::pi * even(engine)) +
                                              b * std::cos(std::numbers::pi * even(engine)));
      held += std::abs(x) <= reach ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(held) / kDraws, 0.9545, 4.0 * std::sqrt(0.9545 * 0.0455 / kDraws))
        << n << " " << r << " " << a << " " << b;
  }
}

TEST(Calibrate, GivesTheSameBitsForAnyNumberOfThreads) {
  const ScanReadings scan = many(36000);  // three blocks
  const CalibratedScan one = calibrated(scan, ordinary(), {.threads = 1});

  for (const int threads : {2, 3}) {
    const CalibratedScan other = calibrated(scan, ordinary(), {.threads = threads});
    ASSERT_EQ(other.points.size(), one.points.size());
    ASSERT_EQ(other.components.size(), one.components.size());
    for (std::size_t n = 0; n < one.points.size(); ++n) {
      ASSERT_EQ(other.points[n].value, one.points[n].value) << n;
      ASSERT_EQ(other.points[n].budget.u, one.points[n].budget.u) << n;
      ASSERT_TRUE(std::ranges::equal(other.points[n].budget.shared, one.points[n].budget.shared)) << n;
      ASSERT_EQ(other.points[n].flags, one.points[n].flags) << n;
    }
  }
}

TEST(Difference, OfTwoScansLeavesOutWhatTheyHaveInCommon) {
  const CalibratedScan a = calibrated(many(4), ordinary());
  const CalibratedScan b = calibrated(many(4), ordinary());

  const ScanDifference both = difference_of(a, a.points[0], b, b.points[0]);

  EXPECT_EQ(both.value, Brdf{});
  EXPECT_LT(both.u, 0.8 * both.u_if_unknown) << "certificate, shape, zeros and linearity cancel";
  EXPECT_GE(both.u.si(), std::numbers::sqrt2 * a.points[0].budget.u_random.si() * (1.0 - 1e-12));
}

TEST(Difference, WithAnotherInstrumentKeepsItsErrors) {
  const ScanReadings scan = many(4);
  InstrumentModel other = ordinary();
  other.version = "8";
  const CalibratedScan a = calibrated(scan, ordinary());
  const CalibratedScan b = calibrated(scan, other);

  EXPECT_GT(difference_of(a, a.points[0], b, b.points[0]).u, difference_of(a, a.points[0], a, a.points[0]).u);
}

}  // namespace
}  // namespace gonio::calibration
