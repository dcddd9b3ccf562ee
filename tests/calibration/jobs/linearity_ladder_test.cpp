// The ladder against a camera that bends and a shutter that opens longer than it says: the simulator's, not ours.
#include "calibration/jobs/linearity_ladder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "calibration/jobs/found_model.h"
#include "sim/optics/detector_response.h"
#include "sim/scene/read_scene.h"
#include "tests/calibration/jobs/job_bench.h"

namespace gonio::calibration {
namespace {

constexpr int kItems = 8;  // of each target
constexpr double kOffset = 40e-6;
const std::vector<double> kExposures{0.001, 0.002, 0.004, 0.008, 0.016, 0.032, 0.064, 0.128};

sim::Scene bent_scene(std::uint64_t seed) {
  sim::Scene scene = sim::read_scene(GONIO_SCENES "/wheat.toml").value();
  scene.seed = seed;
  scene.time_scale = 1.0;
  scene.effects.response = sim::ResponseSpec{.quadratic = -0.03, .cubic = 0.005};
  scene.effects.exposure_offset_s = kOffset;
  return scene;
}

ScanReadings ladder_on(const sim::ReadingLevel& instrument) {
  std::vector<double> up_and_down = kExposures;
  up_and_down.insert(up_and_down.end(), kExposures.rbegin(), kExposures.rend());
  test::JobBench bench(instrument, kExposures);
  const Geometry g{.theta_i = degrees(0.0), .phi_i = {}, .theta_r = degrees(30.0), .phi_r = degrees(90.0)};
  for (int k = 0; k < kItems; ++k) {
    const std::int32_t point = bench.plan(g);
    bench.item(point, g, Target::Sample, up_and_down);
    bench.item(point, g, Target::Reference, up_and_down);
  }
  return bench.finish();
}

// What light over counts is at a share of full scale, 1 for few counts: by the simulator, and as found.
double true_gain(const sim::Scene& scene, double nonlinearity, double counts) {
  double light = counts;
  for (int round = 0; round < 60; ++round) {
    light *= counts / sim::response(*scene.effects.response, light * (1.0 + nonlinearity * light));
  }
  return light / counts;
}
Measured<double> found_gain(const FoundValues& found, double counts) {
  const double a1 = found.values[0].value;
  const double a2 = found.values[1].value;
  const std::size_t n = found.values.size();
  const double x = counts;
  const double variance =
      found.covariance[0] * x * x + 2.0 * found.covariance[1] * x * x * x + found.covariance[n + 1] * x * x * x * x;
  return {.value = 1.0 + a1 * x + a2 * x * x, .u = std::sqrt(variance)};
}

TEST(LinearityLadder, TellsTheExposureOffsetFromTheBend) {
  const sim::Scene scene = bent_scene(7);
  const sim::ReadingLevel instrument(scene);

  const auto found = fit_linearity(ladder_on(instrument), test::told_model(scene), {.order = 2});

  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_EQ(found->values.size(), 3U);
  EXPECT_EQ(found->values[2].name, "exposure_offset_s");
  EXPECT_NEAR(found->values[2].value, kOffset, 4.0 * found->u(2));
  EXPECT_LT(found->u(2), 3e-6) << "0.3 % of the shortest exposure";
  const Measured<double> gain = found_gain(*found, 0.6);
  EXPECT_NEAR(gain.value, true_gain(scene, instrument.truth().nonlinearity(), 0.6), 4.0 * gain.u);
  EXPECT_LT(gain.u, 1e-3);
  EXPECT_LT(found->correlation(0, 2), -0.05) << "they were fitted together: " << found->note;
}

// Share of stated intervals that hold the truth, and RMS of error over u; seeds printed.
TEST(LinearityLadder, StatesUncertaintiesThatHold) {
  constexpr int kRepetitions = 150;
  constexpr std::uint64_t kFirstSeed = 4100;
  double held_offset = 0.0, held_gain = 0.0, z2_offset = 0.0, z2_gain = 0.0;
  for (int k = 0; k < kRepetitions; ++k) {
    const sim::Scene scene = bent_scene(kFirstSeed + static_cast<std::uint64_t>(k));
    const sim::ReadingLevel instrument(scene);
    const auto found = fit_linearity(ladder_on(instrument), test::told_model(scene), {.order = 2});
    ASSERT_TRUE(found) << describe(found.error());
    const double z_offset = (found->values[2].value - kOffset) / found->u(2);
    const Measured<double> gain = found_gain(*found, 0.6);
    const double z_gain = (gain.value - true_gain(scene, instrument.truth().nonlinearity(), 0.6)) / gain.u;
    held_offset += std::abs(z_offset) <= 2.0 ? 1.0 : 0.0;
    held_gain += std::abs(z_gain) <= 2.0 ? 1.0 : 0.0;
    z2_offset += z_offset * z_offset;
    z2_gain += z_gain * z_gain;
  }
  const double n = kRepetitions;
  std::printf("ladder, seeds %llu+%d: t0 held %.1f %%, RMS z %.2f; gain at 0.6 held %.1f %%, RMS z %.2f\n",
              static_cast<unsigned long long>(kFirstSeed), kRepetitions, 100.0 * held_offset / n,
              std::sqrt(z2_offset / n), 100.0 * held_gain / n, std::sqrt(z2_gain / n));

  // 95.45 % of 150: the binomial's 3 sd are 5.1 %.
  EXPECT_NEAR(held_offset / n, 0.9545, 0.051);
  EXPECT_NEAR(held_gain / n, 0.9545, 0.051);
  EXPECT_NEAR(std::sqrt(z2_offset / n), 1.0, 0.17);
  EXPECT_NEAR(std::sqrt(z2_gain / n), 1.0, 0.17);
}

TEST(LinearityLadder, FindsAStraightCameraStraight) {
  sim::Scene scene = bent_scene(11);
  scene.effects = {};
  scene.draws_errors = false;
  const sim::ReadingLevel instrument(scene);

  const auto found = fit_linearity(ladder_on(instrument), test::told_model(scene), {.order = 1});

  ASSERT_TRUE(found) << describe(found.error());
  ASSERT_EQ(found->values.size(), 2U);
  EXPECT_NEAR(found->values[0].value, 0.0, 4.0 * found->u(0));
  EXPECT_NEAR(found->values[1].value, 0.0, 4.0 * found->u(1));
}

TEST(LinearityLadder, RefusesALadderOfTooFewSteps) {
  const sim::Scene scene = bent_scene(3);
  const sim::ReadingLevel instrument(scene);
  test::JobBench bench(instrument, {0.004, 0.008});
  const Geometry g{.theta_i = {}, .phi_i = {}, .theta_r = degrees(30.0), .phi_r = {}};
  bench.item(bench.plan(g), g, Target::Sample, {0.004, 0.008});

  const auto found = fit_linearity(bench.finish(), test::told_model(scene), {.order = 2});

  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::IncompleteData);
  EXPECT_NE(describe(found.error()).find("2 exposures"), std::string::npos) << describe(found.error());
}

TEST(FoundModel, TakesLinearityAndOffsetWithTheirCovarianceAndLeavesNothingOfTheStatedOne) {
  FoundValues found;
  found.values = {{"linearity_1", "1", 0.03}, {"linearity_2", "1", -0.01}, {"exposure_offset_s", "s", 4e-5}};
  found.covariance = {4e-6, 1e-6, -1e-10, 1e-6, 9e-6, 2e-10, -1e-10, 2e-10, 1e-12};
  InstrumentModel stated;
  stated.detector.u_linearity = 0.02;

  const auto model = with_found(stated, found);

  ASSERT_TRUE(model) << describe(model.error());
  EXPECT_EQ(model->detector.linearity.coefficients, (std::vector<double>{0.03, -0.01}));
  EXPECT_EQ(model->detector.linearity.covariance, found.covariance);
  EXPECT_EQ(model->detector.exposure_offset_s.value, 4e-5);
  EXPECT_DOUBLE_EQ(model->detector.exposure_offset_s.u, 1e-6);
  EXPECT_EQ(model->detector.u_linearity, 0.0);
}

TEST(FoundModel, TakesZerosInRadiansAndRefusesACovarianceOfAnotherSize) {
  FoundValues found;
  found.values = {{"zero_theta_i_deg", "deg", 0.1}, {"zero_theta_r_deg", "deg", -0.2}, {"zero_phi_r_deg", "deg", 0.3}};
  found.covariance = {1e-4, 9e-5, 0.0, 9e-5, 1e-4, 0.0, 0.0, 0.0, 4e-4};

  const auto model = with_found({}, found);

  ASSERT_TRUE(model) << describe(model.error());
  EXPECT_NEAR(in_degrees(model->angles.zero[1]), -0.2, 1e-12);
  EXPECT_NEAR(std::sqrt(model->angles.zero_covariance[8]), in_radians(degrees(0.02)), 1e-12);
  EXPECT_NEAR(model->angles.zero_covariance[1] / model->angles.zero_covariance[0], 0.9, 1e-12);
  found.covariance.pop_back();
  EXPECT_EQ(with_found({}, found).error().code, ErrorCode::IncompleteData);
}

}  // namespace
}  // namespace gonio::calibration
