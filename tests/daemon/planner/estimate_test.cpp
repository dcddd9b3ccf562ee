#include "daemon/planner/estimate.h"

#include <gtest/gtest.h>

#include "daemon/planner/light_forecast.h"
#include "daemon/planner/planner.h"
#include "tests/daemon/support/bench_instrument.h"

namespace gonio::daemon {
namespace {

using calibration::Target;
using test::bench_instrument;
using test::bench_plan;

PlannedScan planned(const api::Plan& plan, const TimeExperience& experience = {}) {
  auto scan = expand(plan, bench_instrument(), experience);
  EXPECT_TRUE(scan) << describe(scan.error());
  return scan ? *std::move(scan) : PlannedScan{};
}

TEST(Estimate, CountsVisitsOfTheStandardAndTheSampleWithTheirWays) {
  const api::Plan without = bench_plan({30}, {10, 20, 60}, {90, 120, 150});
  api::Plan with = without;
  with.reference_every = std::chrono::seconds(20);
  with.check_every = std::chrono::seconds(20);

  const TimeParts plain = planned(without).estimate;
  const TimeParts visited = planned(with).estimate;

  EXPECT_GT(visited.move, plain.move);
  EXPECT_GT(visited.settle, plain.settle);
  EXPECT_GT(visited.expose, plain.expose);
}

TEST(Estimate, TakesMotionAndWhatAnItemTakesBeyondFromPastScans) {
  const api::Plan plan = bench_plan({30}, {10, 20, 60}, {90});
  const TimeExperience slower{.scans = 4, .motion = {1.5, 0.1}, .beyond_s = {0.25, 0.05}};

  const PlannedScan by_numbers = planned(plan);
  const PlannedScan by_past = planned(plan, slower);

  EXPECT_NEAR(in_seconds(by_past.estimate.move), 1.5 * in_seconds(by_numbers.estimate.move), 1e-6);
  EXPECT_NEAR(in_seconds(by_past.estimate.settle), 1.5 * in_seconds(by_numbers.estimate.settle), 1e-6);
  // Six items, each 0.25 s instead of the guessed 5 ms.
  EXPECT_NEAR(in_seconds(by_past.estimate.read - by_numbers.estimate.read), 6 * 0.245, 1e-6);
  EXPECT_EQ(by_past.experience.scans, 4);
  EXPECT_GT(by_past.u_estimate_s, 0.0);
}

class Forecast : public testing::Test {
 protected:
  Forecast() { plan.expected_reflectance = 0.5; }
  // 100 000 DN/s of white at 568 nm; the bench's aperture has no radius of its own: one pixel.
  TimeExperience seen{.scans = 1, .white = {{nanometres(568.0), 100'000.0}}};
  api::Plan plan = bench_plan({0, 60}, {20}, {90});
  ScanPoint upright{.geometry = {.theta_i = degrees(0), .theta_r = degrees(20)}, .wavelength = nanometres(568.0)};
  ScanPoint slanting{.geometry = {.theta_i = degrees(60), .theta_r = degrees(20)}, .wavelength = nanometres(568.0)};
};

TEST_F(Forecast, IsAGuessUntilBothTheSampleAndTheStandardAreKnown) {
  const LightForecast unseen(plan, bench_instrument(), {});
  plan.expected_reflectance.reset();
  const LightForecast unsaid(plan, bench_instrument(), seen);

  for (const LightForecast* forecast : {&unseen, &unsaid}) {
    EXPECT_EQ(forecast->of(upright, Target::Sample).exposure, std::chrono::milliseconds(8)) << "of 1 and 64 ms";
    EXPECT_FALSE(forecast->is_known(upright));
    EXPECT_GT(forecast->u_guess_s(), 0.0);
    EXPECT_EQ(forecast->relative_noise(upright, Target::Sample), 1.0 / plan.target_snr);
  }
}

TEST_F(Forecast, GoesByTheRuleOfTheRunWithTheLightThatFallsOnTheSample) {
  plan.target_snr = 10;
  const LightForecast forecast(plan, bench_instrument(), seen);
  // By hand: one frame of 1 ms of white, 100 DN: variance 100/4 + 2 * 1.5^2 = 29.5 DN^2, so 18.4 > 10. Of half of it
  // at 60 deg, 25 DN: sqrt(25/4 + 4.5) = 3.3, so 7.6: 2 ms, 50 DN, 12.1.
  EXPECT_EQ(forecast.of(upright, Target::Reference).exposure, std::chrono::milliseconds(1));
  EXPECT_EQ(forecast.of(slanting, Target::Sample).exposure, std::chrono::milliseconds(2));
  EXPECT_NEAR(forecast.relative_noise(slanting, Target::Sample), std::sqrt(50.0 / 4.0 + 4.5) / 50.0, 1e-9);
}

TEST_F(Forecast, OfAnotherWavelengthThanWasSeenIsAGuess) {
  upright.wavelength = nanometres(633.0);
  const LightForecast forecast(plan, bench_instrument(), seen);

  EXPECT_FALSE(forecast.is_known(upright));
}

TEST_F(Forecast, OfStatedExposuresIsTheirSum) {
  plan.exposures = {std::chrono::milliseconds(1), std::chrono::milliseconds(4)};
  const LightForecast forecast(plan, bench_instrument(), seen);

  EXPECT_EQ(forecast.of(upright, Target::Sample).exposure, std::chrono::milliseconds(5));
  EXPECT_EQ(forecast.of(upright, Target::Sample).frames, 2);
  EXPECT_EQ(forecast.u_guess_s(), 0.0);
}

}  // namespace
}  // namespace gonio::daemon
