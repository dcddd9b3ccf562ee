#include "sim/optics/direct_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/effects/effects_bench.h"

namespace gonio::sim::test {
namespace {

using std::numbers::pi;
constexpr double kOpenMm = 180.0;
constexpr double kSpotMm = 3.0;
constexpr double kFieldMm = 6.0;
constexpr double kStopMm = 10.0;
constexpr double kFarMm = 500.0;

// A spot of 3 mm in a field of 6 mm, a stop of 10 mm at 500 mm, and in slot 2 an attenuator of 1/1000.
Scene with_stop() {
  Scene scene = quiet_scene();
  scene.effects.overlap = OverlapSpec{.spot_radius = millimetres(kSpotMm), .field_radius = millimetres(kFieldMm)};
  scene.effects.stop = StopSpec{.radius = {millimetres(kStopMm), {}}, .distance = {millimetres(kFarMm), {}}};
  scene.stage.open_mm = kOpenMm;
  scene.filters.push_back({.slot = 2,
                           .centroid = nanometres(568.0),
                           .fwhm = nanometres(10.0),
                           .attenuation = Measured<double>{1e-3, 2e-6}});
  return scene;
}

double into_the_source(const Scene& scene, double theta_r_deg, double phi_r_deg = 180.0) {
  StagePose pose = pose_at(at_deg(80.0, theta_r_deg, phi_r_deg), kOpenMm);
  pose.positions[stage::index_of(Axis::FilterWheel)] = 2.0;
  return rate_of(scene, pose).target;
}

// pi sin^2 of the half angle.
double omega_of_a_point() {
  return pi * kStopMm * kStopMm / (kFarMm * kFarMm + kStopMm * kStopMm);
}

TEST(DirectLight, StraightThroughIsAllOfTheBeamBehindTheAttenuator) {
  const double whole = kWhite * std::pow(kSpotMm / kFieldMm, 2) * pi / omega_of_a_point();

  EXPECT_NEAR(into_the_source(with_stop(), 100.0) / (1e-3 * whole), 1.0, 1e-8);
  EXPECT_NEAR(into_the_source(with_stop(), 100.5) / (1e-3 * whole), 1.0, 1e-8) << "4.4 mm off, 7 mm allowed";
}

// At 10 mm off the beam's disc of 3 mm has its middle on the stop's edge: the lens of two circles in closed form.
TEST(DirectLight, BesideTheBeamIsWhatBothDiscsHaveInCommon) {
  const double off = 10.0;
  const double beside_deg = std::atan(off / kFarMm) * 180.0 / pi;
  const auto part = [&](double r, double other) {
    return r * r * std::acos((off * off + r * r - other * other) / (2.0 * off * r));
  };
  const double kite = 0.5 * std::sqrt((-off + kSpotMm + kStopMm) * (off + kSpotMm - kStopMm) *
                                      (off - kSpotMm + kStopMm) * (off + kSpotMm + kStopMm));
  const double lens = part(kSpotMm, kStopMm) + part(kStopMm, kSpotMm) - kite;

  const double share = into_the_source(with_stop(), 100.0 + beside_deg) / into_the_source(with_stop(), 100.0);

  EXPECT_NEAR(share, lens / (pi * kSpotMm * kSpotMm), 1e-9);
  EXPECT_EQ(into_the_source(with_stop(), 103.0), 0.0);
  EXPECT_EQ(into_the_source(with_stop(), 100.0, 0.0), 0.0) << "it looks elsewhere";
}

TEST(DirectLight, NeedsAnOpenPlaceAndAStop) {
  Scene without_stop = with_stop();
  without_stop.effects.stop.reset();
  StagePose before_the_sample = pose_at(at_deg(80.0, 100.0, 180.0));

  EXPECT_EQ(into_the_source(without_stop, 100.0), 0.0);
  EXPECT_EQ(rate_of(with_stop(), before_the_sample).target, 0.0) << "the sample stands in the beam";
}

// Nicodemus 1977: f = P_r / (P_i Omega mu_r) with the spot inside the field. A Lambertian of 0.5 has f = 0.5 / pi.
TEST(DirectLight, AndTheSamplesLightStandAsTheBrdfSays) {
  const Scene scene = with_stop();

  const double ratio = target_rate(scene, at_deg(30, 50, 120)) / (into_the_source(scene, 100.0) / 1e-3);

  EXPECT_NEAR(ratio / (0.5 / pi * omega_of_a_point() * std::cos(in_rad(50.0))), 1.0, 2e-4) << "but for the spot's size";
}

// Walsh's closed form for coaxial discs (1958): F = (S - sqrt(S^2 - 4 (r2/r1)^2)) / 2, S = 1 + (1 + (r2/d)^2) /
// (r1/d)^2.
TEST(DirectLight, StopIsSeenFromAWideSpotAsWalshSays) {
  const double r1 = 30.0 / kFarMm;
  const double r2 = 40.0 / kFarMm;
  const double s = 1.0 + (1.0 + r2 * r2) / (r1 * r1);
  const double walsh = 0.5 * (s - std::sqrt(s * s - 4.0 * r2 * r2 / (r1 * r1)));

  const SolidAngle omega =
      stop_solid_angle({millimetres(40.0), millimetres(kFarMm)}, millimetres(30.0), at_deg(0, 0, 0));

  EXPECT_NEAR(omega.si() / (pi * walsh), 1.0, 2e-6);
}

TEST(DirectLight, StopIsSeenFromAPointAlikeFromAllDirections) {
  const Stop stop{millimetres(kStopMm), millimetres(kFarMm)};

  for (const double theta_r : {0.0, 40.0, 75.0})
    EXPECT_NEAR(stop_solid_angle(stop, {}, at_deg(20, theta_r, 70)).si() / omega_of_a_point(), 1.0, 1e-7) << theta_r;
}

TEST(DirectLight, IsDrawnFromWhatTheCertificatesOfStopAndAttenuatorSay) {
  constexpr int kSeeds = 400;
  constexpr double kFive = 5.0 / 28.3;  // five standard errors of a standard deviation: 5 / sqrt(2 n)
  double radius2 = 0.0;
  double attenuator2 = 0.0;
  Scene scene = with_stop();
  scene.draws_errors = true;
  scene.effects.stop->radius.u = millimetres(0.02);
  for (int seed = 1; seed <= kSeeds; ++seed) {
    scene.seed = static_cast<std::uint64_t>(seed);
    const Truth truth(scene);
    radius2 += std::pow((in_millimetres(truth.stop_radius()) - kStopMm) / 0.02, 2) / kSeeds;
    attenuator2 += std::pow((truth.attenuation(scene.filters[1]) - 1e-3) / 2e-6, 2) / kSeeds;
  }

  EXPECT_NEAR(std::sqrt(radius2), 1.0, kFive);
  EXPECT_NEAR(std::sqrt(attenuator2), 1.0, kFive);
  EXPECT_EQ(Truth(scene).attenuation(scene.filters[0]), 1.0) << "nothing stands beside the other filter";
}

}  // namespace
}  // namespace gonio::sim::test
