// Where the textbook form fails and ours must hold. Each test shows both, so that nobody puts the short form back.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reflectance/integral/compensated_sum.h"
#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/integral/hemisphere_integral.h"
#include "reflectance/surface/fresnel.h"
#include "reflectance/surface/hapke.h"
#include "reflectance/surface/henyey_greenstein.h"
#include "tests/reflectance/generated.h"
#include "tests/reflectance/printed.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

constexpr double kPi = std::numbers::pi;

Direction at(double theta, double phi = 0.0) {
  return Direction::from_angles(radians(theta), radians(phi));
}

double relative_error(double computed, double truth) {
  return std::abs(computed / truth - 1.0);
}

double naive_retro_distance(double ti, double tr, double dphi) {
  const double a = std::tan(ti);
  const double b = std::tan(tr);
  return std::sqrt(a * a + b * b - 2.0 * a * b * std::cos(dphi));
}

TEST(HardCase, RetroDistanceDownTo1e12RadInThePlane) {
  const double ti = 0.5;
  for (const double offset : {1e-6, 1e-8, 1e-10, 1e-12}) {
    const double tr = ti + offset;
    // In the plane G = |tan tr - tan ti| = sin(tr - ti) / (cos ti cos tr); the difference of the doubles is exact.
    const double truth = std::sin(tr - ti) / (std::cos(ti) * std::cos(tr));

    EXPECT_LT(relative_error(retro_distance(at(ti), at(tr)), truth), 1e-15) << offset;
    const double naive_error = relative_error(naive_retro_distance(ti, tr, 0.0), truth);
    EXPECT_FALSE(naive_error < 1e-6) << offset;  // NaN fails it too
  }
}

TEST(HardCase, RetroDistanceDownTo1e12RadInAzimuth) {
  for (const double offset : {1e-6, 1e-8, 1e-10, 1e-12}) {
    const double truth = 2.0 * std::tan(0.5) * std::sin(0.5 * offset);

    EXPECT_LT(relative_error(retro_distance(at(0.5), at(0.5, offset)), truth), 1e-15) << offset;
    EXPECT_FALSE(relative_error(naive_retro_distance(0.5, 0.5, offset), truth) < 1e-6) << offset;
  }
}

TEST(HardCase, RetroDistanceNeverSeesANegativeRadicand) {
  GeneratedDirections directions(20260101);
  int naive_failures = 0;
  for (int k = 0; k < 10000; ++k) {
    const Direction i = at(1.5 * directions.unit());
    const Direction r = at(std::min(1.5, i.theta().si() * (1.0 + 1e-9 * directions.unit())), 1e-9 * directions.unit());
    naive_failures += std::isnan(naive_retro_distance(i.theta().si(), r.theta().si(), r.phi().si())) ? 1 : 0;
    EXPECT_GE(retro_distance(i, r), 0.0);
  }
  EXPECT_GT(naive_failures, 100);
}

TEST(HardCase, RetroDistanceCloseToTheHorizon) {
  // Elevations 2e-12 and 3e-12 rad: tangents 5e11 and 3.3e11, whose difference is the truth.
  const Direction i = Direction::from_elevation(radians(2e-12), {});
  const Direction r = Direction::from_elevation(radians(3e-12), {});

  EXPECT_LT(relative_error(retro_distance(i, r), 1.0 / 2e-12 - 1.0 / 3e-12), 1e-15);
}

TEST(HardCase, PhaseAngleDownTo1e12Rad) {
  for (const double offset : {1e-6, 1e-8, 1e-10, 1e-12}) {
    const double ti = 0.5;
    const double tr = ti + offset;
    const double naive = std::acos(std::cos(ti) * std::cos(tr) + std::sin(ti) * std::sin(tr));

    EXPECT_LT(relative_error(phase_angle(at(ti), at(tr)).si(), tr - ti), 1e-15) << offset;
    EXPECT_FALSE(relative_error(naive, tr - ti) < 1e-6) << offset;
  }
}

TEST(HardCase, PhaseAngleJustShortOf180Deg) {
  // Both close to the horizon, opposite: what is missing to 180 deg is the sum of the elevations.
  const Direction i = Direction::from_elevation(radians(1e-10), {});
  const Direction r = Direction::from_elevation(radians(2e-10), radians(kPi));

  // As a double, pi is 1e-16 short: that counts for 1e-13 here.
  EXPECT_LT(relative_error(std::sqrt(cos2_half_phase(i, r)), std::sin(1.5e-10)), 1e-12);
  EXPECT_LT(relative_error(kPi - phase_angle(i, r).si(), 3e-10), 1e-5);
  EXPECT_EQ(std::acos(-1.0 + 0.5 * 9e-20), kPi);  // the cosine has nothing left of it
}

TEST(HardCase, HenyeyGreensteinNearItsPeak) {
  // 1 + g^2 + 2 g cos xi = (1+g)^2 - 4 g sin^2(xi/2), in the plane with xi = tr - ti.
  const double g = -0.999999;
  const double ti = 0.5;
  const double tr = ti + 1e-7;
  const double s = std::sin(0.5 * (tr - ti));
  const double q = (1.0 + g) * (1.0 + g) - 4.0 * g * s * s;
  const double truth = (1.0 - g) * (1.0 + g) / (q * std::sqrt(q));

  const double ours = HenyeyGreenstein(g)(at(ti), at(tr), separation_terms(at(ti), at(tr)));

  EXPECT_LT(relative_error(ours, truth), 1e-13);
  const double naive = (1.0 - g * g) / std::pow(1.0 + g * g + 2.0 * g * std::cos(tr - ti), 1.5);
  EXPECT_FALSE(relative_error(naive, truth) < 1e-6);
}

// Textbook partial fractions for the integral of eq 7, with gamma from omega0.
double naive_hapke_rho_dh(double mu, double a, double omega0) {
  const double b = 2.0 * std::sqrt(1.0 - omega0);
  const double l1 = std::log(1.0 + b) / b;
  const double l2 = (1.0 - l1) / b;
  const double j = ((1.0 - a * mu) * std::log((1.0 + mu) / mu) + (a - b) * l1) / (1.0 - b * mu);
  return 0.5 * omega0 * (1.0 + a * mu) / (1.0 + b * mu) * (l1 + a * l2 - mu * j);
}

TEST(HardCase, HapkeAlmostWithoutLoss) {
  // By quadrature with 40 digits.
  const struct {
    double co_albedo;
    double mu;
    Printed rho;
  } rows[] = {{1e-8, 1.0, "1.03937085201324512"},  {1e-8, 0.5, "0.999766699994800853"},
              {1e-12, 1.0, "1.03971727084803711"}, {1e-12, 0.5, "0.999997666669999995"},
              {1e-14, 1.0, "1.03972042083999916"}, {1e-14, 0.5, "0.9999997666667"},
              {1e-16, 1.0, "1.03972073583991878"}, {1e-16, 0.5, "0.999999976666667"}};
  for (const auto& row : rows) {
    const Hapke hapke = Hapke::make_from_co_albedo(row.co_albedo).value();
    const Direction i = Direction::from_cosine(row.mu, std::sqrt(1.0 - row.mu * row.mu), {});
    EXPECT_TRUE(agrees(*Surface(hapke).closed_rho_dh(i), row.rho, 4e-15)) << row.co_albedo << " " << row.mu;
  }
  EXPECT_GT(relative_error(naive_hapke_rho_dh(1.0, 2.0, 1.0 - 1e-12), 1.03971727084803711), 1e-11);
  EXPECT_FALSE(relative_error(naive_hapke_rho_dh(1.0, 2.0, 1.0 - 1e-16), 1.03972073583991878) < 1e-3);
}

TEST(HardCase, HapkeWhereTwoGammaMuIsOne) {
  // omega0 = 0.75: gamma = 1/2 exactly, and mu = 1 meets the pole of the partial fractions.
  const struct {
    double distance;
    Printed hapke;
    Printed as_printed;
  } rows[] = {{0.0, "0.23656413280509229", "0.115069807290020509"},
              {0x1p-40, "0.236564132805190107", "0.115069807290086384"},
              {0x1p-20, "0.236564235373499261", "0.115069876364877661"},
              {0x1p-10, "0.236669210074865689", "0.115140584632695814"}};
  for (const auto& row : rows) {
    const double mu = 1.0 - row.distance;
    const Direction i = Direction::from_cosine(mu, std::sqrt((1.0 - mu) * (1.0 + mu)), {});
    EXPECT_TRUE(agrees(*surface("hapke", {{"omega0", 0.75}}).closed_rho_dh(i), row.hapke, 2e-15)) << row.distance;
    EXPECT_TRUE(agrees(*surface("hapke_as_printed", {{"omega0", 0.75}}).closed_rho_dh(i), row.as_printed, 2e-15));
  }
  EXPECT_TRUE(std::isnan(naive_hapke_rho_dh(1.0, 2.0, 0.75)));
  EXPECT_GT(relative_error(naive_hapke_rho_dh(1.0 - 0x1p-40, 2.0, 0.75), 0.236564132805190107), 1e-7);
}

TEST(HardCase, TheHorizonLessTenToTheMinusTenDeg) {
  const double elevation = degrees(1e-10).si();
  const Direction i = Direction::from_elevation(radians(elevation), {});
  const Surface minnaert = surface("minnaert", {{"rho", 0.5}, {"k", 0.5}});

  const double truth = 0.5 / kPi * std::sqrt(std::sin(elevation) * std::sin(elevation));
  EXPECT_LT(relative_error(minnaert.eval(i, i).si(), truth), 1e-15);
  // By way of theta = 90 - 1e-10 deg the cosine has five digits.
  EXPECT_GT(relative_error(std::cos(degrees(90.0 - 1e-10).si()), std::sin(elevation)), 1e-6);
}

TEST(HardCase, NinetyDegreesExactly) {
  const Direction horizon = Direction::from_angles(degrees(90.0), {});

  EXPECT_TRUE(std::isfinite(wheat().eval(horizon, horizon).si()));
  EXPECT_TRUE(std::isfinite(sea().eval(horizon, mirrored(horizon)).si()));
  EXPECT_TRUE(std::isfinite(rho_dh(wheat(), degrees(90.0), 1e-4).value));
  EXPECT_GT(std::tan(horizon.theta().si()), 1e16);  // what G would be made of
}

TEST(HardCase, ThePole) {
  const double tilt = 1e-8;
  const Direction d = Direction::from_vector({.x = tilt, .y = 0.0, .z = 1.0});

  EXPECT_LT(relative_error(d.sin_theta(), tilt), 1e-15);
  EXPECT_EQ(std::sqrt(1.0 - d.mu() * d.mu()), 0.0);  // the short way has nothing left
  EXPECT_EQ(Direction::from_angles({}, degrees(10.0)), Direction::from_angles({}, degrees(200.0)));
}

TEST(HardCase, AnIsotropicSurfaceAcrossTheWrapOfPhi) {
  const Direction i = Direction::from_angles(degrees(30.0), degrees(359.9));
  const Direction r = Direction::from_angles(degrees(30.0), degrees(0.1));

  // 0.2 deg apart in azimuth, not 359.8: G = 2 tan(30 deg) sin(0.1 deg).
  EXPECT_LT(relative_error(retro_distance(i, r), 2.0 * std::tan(kPi / 6.0) * std::sin(degrees(0.1).si())), 1e-12);
}

TEST(HardCase, FresnelAtNormalIncidenceAndBeyondTheCriticalAngle) {
  const double n = 1.34;
  const auto by_sines = [](double ti, double tt) {
    const double s = std::sin(ti - tt) / std::sin(ti + tt);
    const double p = std::tan(ti - tt) / std::tan(ti + tt);
    return 0.5 * (s * s + p * p);
  };

  EXPECT_TRUE(agrees(fresnel(radians(0.0), n).unpolarised(), "0.0211118416246621375", 1e-15));
  EXPECT_TRUE(std::isnan(by_sines(0.0, 0.0)));
  EXPECT_EQ(fresnel(radians(1.0), 1.0 / n).unpolarised(), 1.0);
  EXPECT_TRUE(std::isnan(by_sines(1.0, std::asin(std::sin(1.0) * n))));
}

TEST(HardCase, AHotSpotThatRingsResolveSlowly) {
  // Wheat at 60 deg: the kink at retro and the power of mu at the horizon, against 2048 Gauss nodes in mu.
  const double truth = 0.712386680567085;
  double rings = 0.0;
  for (const HemisphereNode& node : gauss_rings(32, 64)) {
    rings += node.weight_sr * wheat().eval(at(kPi / 3.0), node.direction).si();
  }

  EXPECT_GT(relative_error(rings, truth), 1e-6);
  EXPECT_LT(relative_error(rho_dh(wheat(), at(kPi / 3.0), 1e-12).value, truth), 1e-14);
}

TEST(HardCase, ASumOfManyTermsOfDifferentSize) {
  CompensatedSum sum;
  double naive = 1e16;
  sum.add(1e16);
  for (int k = 0; k < 1000; ++k) {
    sum.add(1.0);
    naive += 1.0;
  }
  sum.add(-1e16);

  EXPECT_EQ(sum.value(), 1000.0);
  EXPECT_EQ(naive - 1e16, 0.0);
}

TEST(HardCase, AMirrorWhichNoGridWouldMeet) {
  // What a quadrature of eval finds of it is nothing; rho_dh has it all the same.
  const Surface mirror = surface("fresnel_mirror", {{"refractive_index", 1.34}});
  double grid = 0.0;
  for (const HemisphereNode& node : gauss_rings(16, 32))
    grid += node.weight_sr * mirror.eval(at(0.5), node.direction).si();

  EXPECT_EQ(grid, 0.0);
  EXPECT_EQ(rho_dh(mirror, at(0.5)).value, fresnel(std::cos(0.5), std::sin(0.5), 1.34).unpolarised());
}

TEST(HardCase, ANarrowLobeThatACoarseGridMisses) {
  const Surface lobe = surface("glint", {{"slope_variance", 0.001}, {"refractive_index", 1e12}});
  const Direction i = Direction::from_angles(degrees(30.0), {});
  const double step = degrees(10.0).si();
  double trapezoid = 0.0;
  for (int t = 0; t < 9; ++t) {
    for (int p = 0; p < 36; ++p) {
      const Direction r = at(t * step, p * step);
      trapezoid += lobe.eval(i, r).si() * r.mu() * r.sin_theta() * step * step;
    }
  }

  const Integral ours = rho_dh(lobe, i, 1e-9);

  EXPECT_NEAR(ours.value, 1.0, 1e-8);
  EXPECT_LE(ours.error, 1e-9);
  EXPECT_GT(std::abs(trapezoid - 1.0), 0.3);
}

}  // namespace
}  // namespace gonio::reflectance
