#include "sim/scene/truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/scene/spectralon_shape.h"
#include "tests/sim/bench.h"

namespace gonio::sim::test {
namespace {

Geometry at(double theta_i, double theta_r, double phi_r) {
  return {degrees(theta_i), degrees(0.0), degrees(theta_r), degrees(phi_r)};
}

// (1/pi) int s mu dOmega at a theta_i by the midpoint rule in theta and phi: independent of the code's own quadrature.
template <class Shape>
double integral_by_midpoints(const Shape& shape, double theta_i_deg = 8.0) {
  constexpr int kTheta = 400;
  constexpr int kPhi = 360;
  double sum = 0.0;
  for (int i = 0; i < kTheta; ++i) {
    const double theta = 90.0 * (i + 0.5) / kTheta;
    const double weight = std::sin(theta * std::numbers::pi / 180.0) * std::cos(theta * std::numbers::pi / 180.0);
    for (int k = 0; k < kPhi; ++k) sum += weight * shape(at(theta_i_deg, theta, 360.0 * (k + 0.5) / kPhi));
  }
  return sum * (std::numbers::pi / 2.0 / kTheta) * (2.0 * std::numbers::pi / kPhi) / std::numbers::pi;
}

TEST(SpectralonShape, IntegratesToOneAtTheCertificatesAngle) {
  EXPECT_NEAR(integral_by_midpoints(SpectralonShape()), 1.0, 1e-5);
}

TEST(SpectralonShape, SendsBackAsMuchLightAsItGetsAtEveryAngle) {
  const SpectralonShape shape;

  for (const double theta_i : {0.0, 30.0, 45.0, 60.0, 70.0, 80.0, 89.0})
    EXPECT_NEAR(integral_by_midpoints(shape, theta_i), 1.0, 3e-5) << theta_i;
}

TEST(SpectralonShape, IsReciprocal) {
  const SpectralonShape shape;

  for (const double phi : {0.0, 45.0, 90.0, 180.0})
    EXPECT_DOUBLE_EQ(shape(at(20.0, 70.0, phi)), shape(at(70.0, 20.0, phi)));
}

TEST(SpectralonShape, HasTheSizesThatArePublishedForSpectralon) {
  const SpectralonShape shape;

  EXPECT_NEAR(0.99 * shape(at(0.0, 45.0, 0.0)), 1.015, 0.02) << "0/45 factor 1.01-1.02";
  EXPECT_GT(shape(at(0.0, 3.0, 0.0)), shape(at(0.0, 45.0, 0.0))) << "opposition rise";
  EXPECT_NEAR(shape(at(60.0, 60.0, 180.0)), 1.2, 0.1);
  EXPECT_NEAR(shape(at(70.0, 70.0, 180.0)), 1.6, 0.15);
  EXPECT_LT(shape(at(0.0, 70.0, 0.0)), 0.98 * shape(at(0.0, 0.0, 0.0))) << "limb darkening";
}

TEST(SpectralonShape, IsHeldByItsGridToWhatTheHeaderSays) {
  const SpectralonShape shape;
  const ShapeGrid grid = shape_grid();
  const auto worst_at_cell_centres = [&](double up_to_deg) {
    double worst = 0.0;
    for (std::size_t i = 0; i + 1 < grid.theta_deg.size(); ++i) {
      for (std::size_t r = 0; r + 1 < grid.theta_deg.size(); ++r) {
        if (std::max(grid.theta_deg[i + 1], grid.theta_deg[r + 1]) > up_to_deg) continue;
        for (std::size_t p = 0; p + 1 < grid.phi_deg.size(); ++p) {
          double corners = 0.0;
          for (unsigned k = 0; k < 8; ++k) {
            corners += shape(at(grid.theta_deg[i + (k & 1U)], grid.theta_deg[r + (k >> 1U & 1U)],
                                grid.phi_deg[p + (k >> 2U)])) /
                       8.0;
          }
          const double centre = shape(at((grid.theta_deg[i] + grid.theta_deg[i + 1]) / 2.0,
                                         (grid.theta_deg[r] + grid.theta_deg[r + 1]) / 2.0,
                                         (grid.phi_deg[p] + grid.phi_deg[p + 1]) / 2.0));
          worst = std::max(worst, std::abs(corners / centre - 1.0));
        }
      }
    }
    return worst;
  };

  EXPECT_LT(worst_at_cell_centres(60.0), 2e-3);
  EXPECT_LT(worst_at_cell_centres(90.0), 4e-3);
}

Scene drawn_scene(std::uint64_t seed) {
  Scene scene = quiet_scene();
  scene.seed = seed;
  scene.draws_errors = true;
  scene.reference.modes = {{.kind = ModeKind::Limb, .u = 0.02},
                           {.kind = ModeKind::Opposition, .u = 0.02, .width = degrees(10.0)}};
  scene.angles = {degrees(0.02), degrees(0.03), degrees(0.04), degrees(0.002)};
  scene.detector.u_linearity = 0.001;
  return scene;
}

TEST(Truth, KeepsTheCertificatesIntegralWhateverModesItDraws) {
  Scene scene = drawn_scene(3);
  scene.reference.certificate[0].uncertainty = 0.0;
  const Truth truth(scene);

  const double integral = integral_by_midpoints(
      [&](const Geometry& g) { return std::numbers::pi * truth.reference(g, nanometres(568.0)).si(); });

  EXPECT_NEAR(integral, 0.99, 2e-5);
  EXPECT_NE(truth.reference(at(60.0, 60.0, 90.0), nanometres(568.0)).si(),
            Truth(drawn_scene(4)).reference(at(60.0, 60.0, 90.0), nanometres(568.0)).si());
}

TEST(Truth, DrawsItsErrorsFromTheStatedUncertainties) {
  constexpr int kSeeds = 4000;
  constexpr double kFive = 5.0 / 89.4;  // five standard errors of a standard deviation: 5 / sqrt(2 n)
  double theta_i2 = 0.0;
  double phi_r2 = 0.0;
  double repeat2 = 0.0;
  double linearity2 = 0.0;
  double reference2 = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Scene scene = drawn_scene(seed);
    scene.reference.modes.clear();
    const Truth truth(scene);
    theta_i2 += std::pow(in_degrees(truth.zero_error(Axis::ThetaI)) / 0.02, 2) / kSeeds;
    phi_r2 += std::pow(in_degrees(truth.zero_error(Axis::PhiR)) / 0.04, 2) / kSeeds;
    repeat2 += std::pow(in_degrees(truth.repeat_error(Axis::ThetaR, 17)) / 0.002, 2) / kSeeds;
    linearity2 += std::pow(truth.nonlinearity() / 0.001, 2) / kSeeds;
    const double exact = 0.99 / std::numbers::pi * SpectralonShape()(at(0.0, 45.0, 0.0));
    reference2 +=
        std::pow((truth.reference(at(0.0, 45.0, 0.0), nanometres(568.0)).si() / exact - 1.0) / (0.0025 / 0.99), 2) /
        kSeeds;
  }

  EXPECT_NEAR(std::sqrt(theta_i2), 1.0, kFive);
  EXPECT_NEAR(std::sqrt(phi_r2), 1.0, kFive);
  EXPECT_NEAR(std::sqrt(repeat2), 1.0, kFive);
  EXPECT_NEAR(std::sqrt(linearity2), 1.0, kFive);
  EXPECT_NEAR(std::sqrt(reference2), 1.0, kFive);
}

TEST(Truth, IsExactlyAsStatedWithoutDraws) {
  Scene scene = drawn_scene(3);
  scene.draws_errors = false;
  const Truth truth(scene);

  EXPECT_EQ(in_degrees(truth.zero_error(Axis::ThetaR)), 0.0);
  EXPECT_DOUBLE_EQ(truth.reference(at(10.0, 45.0, 90.0), nanometres(568.0)).si(),
                   0.99 * SpectralonShape()(at(10.0, 45.0, 90.0)) / std::numbers::pi);
}

TEST(Truth, TakesAnArmBeyondItsZeroForTheOtherSideOfThePole) {
  Scene scene = quiet_scene();
  scene.sample = {
      {.surface = *reflectance::make_surface("rpv", {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}}), .weight = 1.0}};
  const Truth truth(scene);

  EXPECT_DOUBLE_EQ(truth.sample(at(-5.0, 30.0, 0.0)).si(), truth.sample(at(5.0, 30.0, 180.0)).si());
}

TEST(Truth, AddsTheTermsOfASumByTheirWeights) {
  Scene scene = quiet_scene();
  scene.sample.push_back({.surface = *reflectance::make_surface("lambertian", {{"rho", 1.0}}), .weight = 0.25});

  EXPECT_DOUBLE_EQ(Truth(scene).sample(at(30.0, 40.0, 50.0)).si(), 0.75 / std::numbers::pi);
}

}  // namespace
}  // namespace gonio::sim::test
