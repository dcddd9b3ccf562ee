// Zeros of the arms from the lobe of a mirror, against those that the simulator has drawn and tells nobody.
#include "calibration/jobs/arm_zeros.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include "sim/scene/read_scene.h"
#include "tests/calibration/jobs/job_bench.h"

namespace gonio::calibration {
namespace {

using stage::Axis;

constexpr std::array<Axis, 3> kAxes{Axis::ThetaI, Axis::ThetaR, Axis::PhiR};

sim::Scene mirror_scene(std::uint64_t seed, double u_zero_deg) {
  sim::Scene scene = sim::read_scene(GONIO_SCENES "/mirror.toml").value();
  scene.seed = seed;
  scene.time_scale = 1.0;
  scene.angles.u_zero_theta_i = degrees(u_zero_deg);
  scene.angles.u_zero_theta_r = degrees(u_zero_deg);
  scene.angles.u_zero_phi_r = degrees(u_zero_deg);
  return scene;
}

void cross(test::JobBench& bench, const std::vector<Geometry>& line) {
  for (const Geometry& g : line) bench.item(bench.plan(g), g, Target::Sample, {0.002});
}

Geometry at(double theta_i, double theta_r, double phi_r) {
  return {.theta_i = degrees(theta_i), .phi_i = {}, .theta_r = degrees(theta_r), .phi_r = degrees(phi_r)};
}

ScanReadings crossings(const sim::ReadingLevel& instrument, bool across_normal) {
  test::JobBench bench(instrument, {0.002});
  for (const double theta : {15.0, 35.0, 55.0}) {
    std::vector<Geometry> along_theta, along_phi;
    for (int k = -5; k <= 5; ++k) {
      const double offset = 0.08 * k;
      along_theta.push_back(at(theta, theta + offset, 180.0));
      if (k != 0) along_phi.push_back(at(theta, theta, 180.0 + offset / std::sin(in_radians(degrees(theta)))));
    }
    cross(bench, along_theta);
    cross(bench, along_phi);
  }
  for (int turn = 0; across_normal && turn < 4; ++turn) {
    std::vector<Geometry> outward;
    for (int k = 1; k <= 10; ++k) outward.push_back(at(0.0, 0.04 * k, 90.0 * turn));
    cross(bench, outward);
  }
  return bench.finish();
}

double true_zero_deg(const sim::ReadingLevel& instrument, std::size_t axis) {
  return in_degrees(instrument.truth().zero_error(kAxes[axis]));
}

TEST(ArmZeros, FindsEachZeroWhereTheNormalCanBeCrossed) {
  const sim::Scene scene = mirror_scene(5, 0.1);
  const sim::ReadingLevel instrument(scene);

  const auto found = fit_arm_zeros(crossings(instrument, true), test::told_model(scene), {.u_mirror = degrees(0.0)});

  ASSERT_TRUE(found) << describe(found.error());
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    SCOPED_TRACE(found->values[axis].name + ", " + found->note);
    EXPECT_NEAR(found->values[axis].value, true_zero_deg(instrument, axis), 4.0 * found->u(axis));
    EXPECT_LT(found->u(axis), 0.01) << "a tenth of what was stated";
  }
}

TEST(ArmZeros, WithoutTheNormalKnowsTheDifferenceAndSaysSo) {
  const sim::Scene scene = mirror_scene(6, 0.1);
  const sim::ReadingLevel instrument(scene);

  const auto found = fit_arm_zeros(crossings(instrument, false), test::told_model(scene), {.u_mirror = degrees(0.0)});

  ASSERT_TRUE(found) << describe(found.error());
  const double difference = found->values[0].value - found->values[1].value;
  const double u_difference = std::sqrt(found->covariance[0] + found->covariance[4] - 2.0 * found->covariance[1]);
  EXPECT_NEAR(difference, true_zero_deg(instrument, 0) - true_zero_deg(instrument, 1), 4.0 * u_difference);
  EXPECT_LT(u_difference, 0.005);
  EXPECT_GT(found->u(0), 0.06) << "half of the stated uncertainties is the sum's";
  EXPECT_GT(found->correlation(0, 1), 0.99);
  EXPECT_NE(found->note.find("known by their difference"), std::string::npos) << found->note;
}

TEST(ArmZeros, BelievesTheMirrorWhenTheStatedUncertaintyIsFarTooSmall) {
  const sim::Scene scene = mirror_scene(5, 0.1);
  const sim::ReadingLevel instrument(scene);
  InstrumentModel boastful = test::told_model(scene);
  boastful.angles.u_zero_theta_i = boastful.angles.u_zero_theta_r = degrees(0.001);

  const auto seen_across = fit_arm_zeros(crossings(instrument, true), boastful, {});
  const auto by_difference = fit_arm_zeros(crossings(instrument, false), boastful, {});

  ASSERT_TRUE(seen_across && by_difference);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    EXPECT_NEAR(seen_across->values[axis].value, true_zero_deg(instrument, axis), 4.0 * seen_across->u(axis));
    EXPECT_NEAR(by_difference->values[axis].value, true_zero_deg(instrument, axis), 4.0 * by_difference->u(axis));
  }
}

TEST(ArmZeros, AMirrorThatMayLeanLeavesTheZeroOfTheSourceTwiceAsUncertain) {
  const sim::Scene scene = mirror_scene(5, 0.1);
  const sim::ReadingLevel instrument(scene);
  const ScanReadings scan = crossings(instrument, true);

  const auto found = fit_arm_zeros(scan, test::told_model(scene), {.u_mirror = degrees(0.02)});

  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_NEAR(found->u(0), 0.04, 0.005);
  EXPECT_LT(found->u(1), 0.01) << "the detector's zero is its way across the normal, however the mirror leans";
}

// Never too small: along a crossing one axis may stand still, which this bench does not do, so u is on the large side.
TEST(ArmZeros, StatesUncertaintiesThatHold) {
  constexpr int kRepetitions = 150;
  constexpr std::uint64_t kFirstSeed = 5200;
  std::array<double, 3> held{}, z2{};
  for (int k = 0; k < kRepetitions; ++k) {
    const sim::Scene scene = mirror_scene(kFirstSeed + static_cast<std::uint64_t>(k), 0.05);
    const sim::ReadingLevel instrument(scene);
    const auto found = fit_arm_zeros(crossings(instrument, k % 2 == 0), test::told_model(scene), {});
    ASSERT_TRUE(found) << describe(found.error());
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
      const double z = (found->values[axis].value - true_zero_deg(instrument, axis)) / found->u(axis);
      held[axis] += std::abs(z) <= 2.0 ? 1.0 / kRepetitions : 0.0;
      z2[axis] += z * z / kRepetitions;
    }
  }
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    std::printf("arm zeros, seeds %llu+%d: %s held %.1f %%, RMS z %.2f\n", static_cast<unsigned long long>(kFirstSeed),
                kRepetitions, std::string(stage::axis_name(kAxes[axis])).c_str(), 100.0 * held[axis],
                std::sqrt(z2[axis]));
    EXPECT_GE(held[axis], 0.9545 - 0.051);
    EXPECT_LE(std::sqrt(z2[axis]), 1.17);
  }
}

// The simulator reflects at the leaning normal itself (sim/optics/mounting.h): no formula of the fit's.
sim::Scene leaning_mirror(std::uint64_t seed, double lean_0_deg, double lean_90_deg) {
  sim::Scene scene = mirror_scene(seed, 0.05);
  scene.effects.mounting = sim::MountingSpec{
      .sample = {.lean_0 = degrees(lean_0_deg), .lean_90 = degrees(lean_90_deg), .height = {}}, .reference = {}};
  return scene;
}

TEST(ArmZeros, AMirrorThatLeansAcrossThePlaneBendsNoZero) {
  for (const bool across_normal : {true, false}) {
    for (const double lean : {0.06, -0.06}) {
      const sim::Scene scene = leaning_mirror(9, 0.0, lean);
      const sim::ReadingLevel instrument(scene);

      const auto found = fit_arm_zeros(crossings(instrument, across_normal), test::told_model(scene), {});

      ASSERT_TRUE(found) << describe(found.error());
      SCOPED_TRACE(found->note);
      EXPECT_NEAR(found->values[2].value, true_zero_deg(instrument, 2), 4.0 * found->u(2));
      EXPECT_LT(found->u(2), 0.02);
      const std::string words = "the mirror leans ";
      const std::size_t at_lean = found->note.find(words);
      ASSERT_NE(at_lean, std::string::npos);
      EXPECT_NEAR(std::stod(found->note.substr(at_lean + words.size())), lean, 0.01);
      EXPECT_NE(found->note.find("more than u_mirror_deg says"), std::string::npos);
    }
  }
}

// The lean in the plane is drawn with the u that is stated, the one across it with more.
TEST(ArmZeros, StatesUncertaintiesThatHoldForMirrorsThatLean) {
  constexpr int kRepetitions = 300;
  constexpr std::uint64_t kFirstSeed = 6200;
  constexpr double kMirrorDeg = 0.02;
  std::mt19937_64 random(kFirstSeed);
  std::normal_distribution<double> in_plane(0.0, kMirrorDeg), across(0.0, 0.04);
  std::array<double, 3> held{}, z2{};
  for (int k = 0; k < kRepetitions; ++k) {
    const double lean_0 = in_plane(random);
    const double lean_90 = across(random);
    const sim::Scene scene = leaning_mirror(kFirstSeed + static_cast<std::uint64_t>(k), lean_0, lean_90);
    const sim::ReadingLevel instrument(scene);
    const auto found =
        fit_arm_zeros(crossings(instrument, k % 2 == 0), test::told_model(scene), {.u_mirror = degrees(kMirrorDeg)});
    ASSERT_TRUE(found) << describe(found.error());
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
      const double z = (found->values[axis].value - true_zero_deg(instrument, axis)) / found->u(axis);
      held[axis] += std::abs(z) <= 2.0 ? 1.0 / kRepetitions : 0.0;
      z2[axis] += z * z / kRepetitions;
    }
  }
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    std::printf("arm zeros, leaning mirrors, seeds %llu+%d: %s held %.1f %%, RMS z %.2f\n",
                static_cast<unsigned long long>(kFirstSeed), kRepetitions,
                std::string(stage::axis_name(kAxes[axis])).c_str(), 100.0 * held[axis], std::sqrt(z2[axis]));
    // Three standard deviations of what as many draws of a normal error would show.
    EXPECT_GE(held[axis], 0.9545 - 0.036);
    EXPECT_LE(std::sqrt(z2[axis]), 1.0 + 3.0 / std::sqrt(2.0 * kRepetitions));
  }
}

TEST(ArmZeros, RefusesAMirrorWhosePeakWasNotFound) {
  const sim::Scene scene = mirror_scene(5, 0.0);
  const sim::ReadingLevel instrument(scene);
  test::JobBench bench(instrument, {0.002});
  for (const double theta : {15.0, 35.0, 55.0}) {
    for (int k = 3; k <= 8; ++k) {
      const Geometry g = at(theta, theta + 0.1 * k, 180.0);
      bench.item(bench.plan(g), g, Target::Sample, {0.002});
    }
  }

  const auto found = fit_arm_zeros(bench.finish(), test::told_model(scene), {});

  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::IncompleteData);
  EXPECT_NE(describe(found.error()).find("three at least"), std::string::npos);
}

}  // namespace
}  // namespace gonio::calibration
