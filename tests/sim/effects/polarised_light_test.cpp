#include "sim/optics/polarised_light.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "reflectance/surface/fresnel.h"
#include "tests/sim/effects/effects_bench.h"

namespace gonio::sim::test {
namespace {

constexpr double kN = 1.34;

Scene polarised(const reflectance::Surface& surface, const PolarisationSpec& spec) {
  Scene scene = scene_with(surface);
  scene.effects.polarisation = spec;
  return scene;
}

/// What polarisation makes of the signal.
double factor(const reflectance::Surface& surface, const PolarisationSpec& spec, const Geometry& g) {
  return target_rate(polarised(surface, spec), g) / target_rate(scene_with(surface), g);
}

TEST(PolarisedLight, IsUnpolarisedLightWhereNothingPrefersAPlane) {
  EXPECT_NEAR(factor(sea(), {}, at_deg(30, 50, 140)), 1.0, 1e-14);
}

TEST(PolarisedLight, ReflectsAsFresnelSaysInThePlaneOfIncidence) {
  const Geometry g = at_deg(30, 60, 180);
  const auto r = reflectance::fresnel(degrees(45.0), kN);  // the facet's angle: half of the 90 deg between

  const double s = factor(sea(), {.source_degree = 1.0}, g);
  const double p = factor(sea(), {.source_degree = 1.0, .source_plane = degrees(90.0)}, g);
  const double partly = factor(sea(), {.source_degree = 0.3}, g);

  EXPECT_NEAR(s, r.s / r.unpolarised(), 1e-13);
  EXPECT_NEAR(p, r.p / r.unpolarised(), 1e-13);
  EXPECT_NEAR(partly, 1.0 + 0.3 * (r.s - r.p) / (r.s + r.p), 1e-13);
}

TEST(PolarisedLight, IsGoneAtBrewstersAngleInThePlaneOfIncidence) {
  const double brewster = std::atan(kN) * 180.0 / std::numbers::pi;

  const double p =
      factor(sea(), {.source_degree = 1.0, .source_plane = degrees(90.0)}, at_deg(brewster, brewster, 180));

  EXPECT_NEAR(p, 0.0, 1e-14);
}

TEST(PolarisedLight, IsTakenOrLeftByTheDetectorAsByThePrincipleOfReversal) {
  // A detector that prefers a plane and a lamp that has it give the same light: reciprocity.
  const Geometry there = at_deg(30, 60, 140);
  const Geometry back{.theta_i = there.theta_r, .phi_i = there.phi_r, .theta_r = there.theta_i, .phi_r = there.phi_i};

  const double seen = factor(sea(), {.detector_diattenuation = 0.7, .detector_plane = degrees(25.0)}, there);
  const double lit = factor(sea(), {.source_degree = 0.7, .source_plane = degrees(25.0)}, back);

  EXPECT_NEAR(seen, lit, 1e-13);
}

// The same by Stokes vectors and a Mueller matrix, out of the plane: angles between the arms' planes and the plane of
// the two directions, turned the same way seen against the light; the mirror's s and p amplitudes couple U.
double by_mueller(const PolarisationSpec& spec, const Geometry& g) {
  using V = std::array<double, 3>;
  const auto dot3 = [](const V& a, const V& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  const auto cross3 = [](const V& a, const V& b) {
    return V{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const auto along = [](double theta, double phi) {
    return V{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
  };
  const V i = along(g.theta_i.si(), g.phi_i.si()), r = along(g.theta_r.si(), g.phi_r.si());
  V s = cross3(i, r);
  const double norm = std::sqrt(dot3(s, s));
  for (double& c : s) c /= norm;
  const V p_in = cross3(s, V{-i[0], -i[1], -i[2]}), p_out = cross3(s, r);
  const auto plane = [&](const V& d, double phi, double angle) {
    const V across{-std::sin(phi), std::cos(phi), 0.0};
    const V up = cross3(d, across);
    V e{};
    for (std::size_t k = 0; k < 3; ++k) e[k] = std::cos(angle) * across[k] + std::sin(angle) * up[k];
    return e;
  };
  const V lamp = plane(i, g.phi_i.si(), spec.source_plane.si());
  const V eye = plane(r, g.phi_r.si(), spec.detector_plane.si());
  const double alpha = std::atan2(dot3(lamp, p_in), dot3(lamp, s));
  const double beta = std::atan2(dot3(eye, p_out), dot3(eye, s));
  const double half = 0.5 * std::acos(dot3(i, r));
  const double t = std::asin(std::sin(half) / kN);
  const double rs = -std::sin(half - t) / std::sin(half + t), rp = std::tan(half - t) / std::tan(half + t);
  const double mean = 0.5 * (rs * rs + rp * rp), half_difference = 0.5 * (rs * rs - rp * rp);
  const double big_p = spec.source_degree, big_d = spec.detector_diattenuation;
  const double q_in = big_p * std::cos(2 * alpha), u_in = big_p * std::sin(2 * alpha);
  const double q_out = half_difference + mean * q_in, u_out = rs * rp * u_in, i_out = mean + half_difference * q_in;
  return (i_out + big_d * (std::cos(2 * beta) * q_out + std::sin(2 * beta) * u_out)) / mean;
}

TEST(PolarisedLight, IsThatOfStokesAndMuellerOutOfThePlane) {
  for (const double phi : {20.0, 90.0, 135.0, 250.0}) {
    for (const double plane : {0.0, 30.0, 80.0}) {
      const PolarisationSpec spec{.source_degree = 0.8,
                                  .source_plane = degrees(plane),
                                  .detector_diattenuation = 0.5,
                                  .detector_plane = degrees(55.0 - plane)};
      const Geometry g = at_deg(35, 50, phi);
      EXPECT_NEAR(factor(sea(), spec, g), by_mueller(spec, g), 1e-12) << phi << " " << plane;
    }
  }
}

TEST(PolarisedLight, IsForgottenByAMattSurfaceAndByTheReference) {
  const PolarisationSpec both{.source_degree = 1.0, .detector_diattenuation = 1.0, .detector_plane = degrees(90.0)};
  const Geometry g = at_deg(30, 60, 180);

  EXPECT_NEAR(factor(wheat(), both, g), 1.0, 1e-14);
  EXPECT_EQ(target_rate(polarised(sea(), both), g, kReferenceMm), target_rate(scene_with(sea()), g, kReferenceMm));
}

TEST(PolarisedLight, OfASumIsTheSumOfItsTerms) {
  const PolarisationSpec s_light{.source_degree = 1.0};
  const Geometry g = at_deg(30, 60, 180);
  Scene scene = polarised(sea(), s_light);
  scene.sample.push_back({.surface = wheat(), .weight = 0.1});

  const double expected = target_rate(polarised(sea(), s_light), g) + 0.1 * target_rate(scene_with(wheat()), g);

  EXPECT_NEAR(target_rate(scene, g) / expected, 1.0, 1e-14);
}

TEST(PolarisedLight, HasItsPlaneFromTheArmEvenWhereAConeHoldsTheNormal) {
  // At theta = 0 the directions of a cone have every azimuth; the lamp's plane does not turn with them.
  const PolarisationSpec spec{.source_degree = 1.0, .detector_diattenuation = 1.0};
  Scene scene = polarised(sea(), spec);
  scene.effects.cones = ConeSpec{.source_half = degrees(1.0), .detector_half = degrees(1.0)};
  Scene plain = scene_with(sea());
  plain.effects.cones = scene.effects.cones;

  // Parallel planes, straight back: all light passes both, twice the mean of two planes.
  EXPECT_NEAR(target_rate(scene, at_deg(0, 0, 0)) / target_rate(plain, at_deg(0, 0, 0)), 2.0, 1e-3);
}

}  // namespace
}  // namespace gonio::sim::test
