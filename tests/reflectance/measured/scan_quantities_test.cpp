#include "reflectance/measured/scan_quantities.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/light/lit_reflectance.h"
#include "reflectance/light/uniform_sky.h"
#include "tests/reflectance/measured/simulated_scan.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance::test {
namespace {

using ::testing::HasSubstr;

const SimulatedGrid kGrid{
    .theta_i = {0, 20, 40, 60, 75}, .theta_r = {0, 10, 20, 30, 40, 50, 60, 70, 80}, .phi_step = 15};

Direction at_theta(double theta_deg) {
  return Direction::from_angles(degrees(theta_deg), Angle{});
}

ScanQuantities quantities_of(const MeasuredScan& scan, std::optional<CapModel> cap = std::nullopt) {
  return ScanQuantities::make(scan, {}, std::move(cap)).value();
}

// Within what the quantity itself says, by k = 3.
void expect_holds(const ScanQuantity& q, double truth) {
  EXPECT_NEAR(q.value, truth, 3.0 * q.u) << q.name << ", u " << q.u;
}

TEST(ScanQuantities, AreTrueForAPerfectCanopyWithinTheirUncertainty) {
  const ScanQuantities quantities = quantities_of(perfect_scan(wheat(), geometries(kGrid)));
  const Light sky = Sky(UniformSky::make(1.0).value());
  const Direction r = at_theta(35.0);

  for (const double theta : {0.0, 20.0, 30.0, 60.0}) {
    const ScanQuantity q = quantities.rho_dh(at_theta(theta)).value();
    expect_holds(q, rho_dh(wheat(), at_theta(theta)).value);
    EXPECT_NEAR(q.value / rho_dh(wheat(), at_theta(theta)).value, 1.0, 0.01);
  }
  expect_holds(quantities.bond_albedo().value(), bond_albedo(wheat()).value);
  expect_holds(quantities.rho_hd(r).value(), rho_hd(wheat(), r).value);
  expect_holds(quantities.radf_normal_incidence(r).value(), std::numbers::pi * wheat().eval(Direction(), r).si());
  expect_holds(quantities.reflectance_under(sky).value(), bond_albedo(wheat()).value);
  expect_holds(quantities.remote_sensing_reflectance(sky, r).value(),
               remote_sensing_reflectance(wheat(), sky, r).value().value);
}

TEST(ScanQuantities, AreTheAlbedoOfALambertianToItsLastPercent) {
  const Surface lambertian = surface("lambertian", {{"rho", 0.4}});
  const ScanQuantities quantities = quantities_of(perfect_scan(lambertian, geometries(kGrid)));

  EXPECT_NEAR(quantities.rho_dh(at_theta(40.0)).value().value, 0.4, 1e-6);
  EXPECT_NEAR(quantities.bond_albedo().value().value, 0.4, 1e-6);
}

TEST(ScanQuantities, OfABeamIsRhoDhOfItsDirection) {
  const ScanQuantities quantities = quantities_of(perfect_scan(wheat(), geometries(kGrid)));
  const Light beam = Beam::make(at_theta(40.0), 3.0).value();

  EXPECT_NEAR(quantities.reflectance_under(beam).value().value, quantities.rho_dh(at_theta(40.0)).value().value, 1e-12);
}

TEST(ScanQuantities, AddRandomErrorsInQuadratureAndSharedOnesAtOnce) {
  const Surface lambertian = surface("lambertian", {{"rho", 0.5}});
  const SimulatedErrors errors{
      .noise = 0.01, .least_noise = 0.0, .certificate = 0.02, .limb = 0.0, .zero_theta_r = 0.0, .background = 0.0};
  MeasuredScan scan = simulated_scan(lambertian, geometries(kGrid), errors, 1);
  for (MeasuredPoint& p : scan.points) p.value = per_steradian(0.5 / std::numbers::pi);  // keep u, drop the errors

  const ScanQuantity q = quantities_of(scan).rho_dh(at_theta(40.0)).value();

  // The certificate lifts all readings together: 2 % of the value. Some hundred readings average their own out.
  EXPECT_NEAR(q.u_shared / q.value, 0.02, 4e-4);
  EXPECT_LT(q.u_random / q.value, 0.01 / 5.0);
  EXPECT_GT(q.u_random / q.value, 0.01 / 15.0);
}

TEST(ScanQuantities, TellHowMuchOfTheValueWasNotMeasured) {
  SimulatedGrid short_arm = kGrid;
  short_arm.theta_r = {0, 10, 20, 30, 40, 50, 60};
  const Surface lambertian = surface("lambertian", {{"rho", 0.5}});
  const ScanQuantities quantities = quantities_of(perfect_scan(lambertian, geometries(short_arm)));

  const ScanQuantity q = quantities.rho_dh(at_theta(40.0)).value();

  // cos^2(60 deg) of the projected hemisphere lies beyond 60 deg.
  EXPECT_NEAR(q.modelled_share, 0.25, 0.01);
  EXPECT_NEAR(quantities.unmeasured_share(at_theta(40.0)), 0.25, 0.01);
  EXPECT_NEAR(q.value, 0.5, 1e-6);
}

TEST(ScanQuantities, PutTheCapModelWhereNothingWasMeasured) {
  SimulatedGrid short_arm = kGrid;
  short_arm.theta_r = {0, 10, 20, 30, 40, 50, 60};
  const MeasuredScan scan = perfect_scan(surface("lambertian", {{"rho", 0.5}}), geometries(short_arm));
  const Surface darker = surface("lambertian", {{"rho", 0.3}});

  const ScanQuantity exact =
      quantities_of(scan, CapModel{.surface = darker, .parameters = {}, .rivals = {}}).rho_dh(at_theta(40.0)).value();
  const ScanQuantity doubted =
      quantities_of(scan, CapModel{.surface = darker,
                                   .parameters = {},
                                   .rivals = {{.surface = surface("lambertian", {{"rho", 0.5}}), .weight = 0.5}}})
          .rho_dh(at_theta(40.0))
          .value();

  EXPECT_NEAR(exact.value, 0.75 * 0.5 + 0.25 * 0.3, 3e-3);
  EXPECT_EQ(exact.u_modelled, 0.0);
  // Half of the rival, 0.05 above: the models' spread about their mean, and the mean's distance from the value.
  EXPECT_NEAR(doubted.u_modelled, std::sqrt(2.0) * 0.025, 1e-3);
}

TEST(ScanQuantities, SaysThatOneIncidenceIsNotAllOfThem) {
  SimulatedGrid one = kGrid;
  one.theta_i = {30};
  const ScanQuantities quantities = quantities_of(perfect_scan(wheat(), geometries(one)));

  EXPECT_TRUE(quantities.rho_dh(at_theta(30.0)));
  EXPECT_THAT(quantities.bond_albedo().error().seen, HasSubstr("one theta_i only, 30 deg"));
  EXPECT_THAT(quantities.rho_hd(Direction()).error().seen, HasSubstr("one theta_i only"));
  EXPECT_THAT(quantities.rho_dh(at_theta(80.0)).error().seen, HasSubstr("under 30 to 30 deg"));
}

TEST(ScanQuantities, RefusesALightThatIsDark) {
  const ScanQuantities quantities = quantities_of(perfect_scan(wheat(), geometries(kGrid)));
  const Light dark = Sky(UniformSky::make(0.0).value());

  EXPECT_EQ(quantities.reflectance_under(dark).error().seen, "E_d = 0");
}

TEST(ScanQuantities, RefusesACapOfAnotherScan) {
  const MeasuredScan scan = perfect_scan(wheat(), geometries(kGrid));
  const CapModel cap{
      .surface = wheat(), .parameters = {{.shifted = wheat(), .shift = 0.1, .per_reading = {1.0}}}, .rivals = {}};

  EXPECT_EQ(ScanQuantities::make(scan, {}, cap).error().code, ErrorCode::InvalidInput);
}

}  // namespace
}  // namespace gonio::reflectance::test
