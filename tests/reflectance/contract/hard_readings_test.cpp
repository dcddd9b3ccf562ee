// Where readings, tables and samplers are handled in the obvious way, and it is wrong. Each test shows both; its name
// is the case's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/sampling/make_sampler.h"
#include "reflectance/sampling/table_sampler.h"
#include "reflectance/surface/surface_sum.h"
#include "reflectance/table/tabulated_surface.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kSeed = 20260402;

Direction at_deg(double theta, double phi = 0.0) {
  return Direction::from_angles(degrees(theta), degrees(phi));
}

TableReading reading(double theta_i, double theta_r, double phi_r, double f, double u = 0.0) {
  return {.geometry = geometry(theta_i, theta_r, phi_r), .f = {.value = per_steradian(f), .u = per_steradian(u)}};
}

// f at (30, theta_r, phi_r), theta_r = 0 to `last`, phi_r all around.
template <class F>
std::vector<TableReading> rings_at_30(double last, F f) {
  std::vector<TableReading> readings{reading(30, 0, 0, f(0.0, 0.0))};
  for (double theta = 10.0; theta <= last; theta += 10.0) {
    for (double phi = 0.0; phi < 360.0; phi += 10.0) readings.push_back(reading(30, theta, phi, f(theta, phi)));
  }
  return readings;
}

TabulatedSurface table(const std::vector<TableReading>& readings, TableSymmetry symmetry = TableSymmetry::Turn) {
  TableOptions options;
  options.symmetry = symmetry;
  options.layout = TableLayout::Rings;
  return TabulatedSurface::make(readings, options).value();
}

TEST(HardCase, Theta0PoleReadings) {
  // The pole was read on three planes; as rows of a grid these are three values of one direction.
  std::vector<TableReading> readings = rings_at_30(80.0, [](double, double) { return 0.2; });
  readings.front() = reading(30, 0, 0, 0.19, 0.01);
  readings.push_back(reading(30, 0, 120, 0.20, 0.01));
  readings.push_back(reading(30, 0, 240, 0.24, 0.01));

  const TabulatedSurface surface = table(readings);

  ASSERT_EQ(surface.report().merged.size(), 1U);
  EXPECT_EQ(surface.report().merged[0].count, 3U);
  for (const double phi : {0.0, 120.0, 240.0, 77.0}) {
    EXPECT_NEAR(surface.eval(at_deg(30), at_deg(0, phi)).si(), 0.21, 1e-12) << phi;
  }
}

TEST(HardCase, PhiWrapBetweenReadings) {
  // Bright from phi = 350 to 10 deg; a line through the azimuths as numbers from 0 to 360 knows no way from 355 to 5.
  const TabulatedSurface surface =
      table(rings_at_30(80.0, [](double, double phi) { return std::min(phi, 360.0 - phi) < 15.0 ? 0.9 : 0.1; }));

  for (const double phi : {355.0, -5.0, 359.9, 0.1, 5.0}) {
    EXPECT_NEAR(surface.eval(at_deg(30), at_deg(50, phi)).si(), 0.9, 1e-12) << phi;
  }
  const double naive_mean_of_azimuths = 0.5 * (350.0 + 10.0);
  EXPECT_NEAR(surface.eval(at_deg(30), at_deg(50, naive_mean_of_azimuths)).si(), 0.1, 1e-12);
}

TEST(HardCase, RetroAndSpecularSwapped) {
  // A single bright reading at (30, 30, 0): retro-reflection. Codes that have forward at 0 put it at 180.
  const TabulatedSurface surface =
      table(rings_at_30(80.0, [](double theta, double phi) { return theta == 30.0 && phi == 0.0 ? 1.0 : 0.1; }));
  const Direction i = at_deg(30);
  const Direction forward_at_0 = at_deg(30, 180.0 - 0.0);

  EXPECT_NEAR(surface.eval(i, i).si(), 1.0, 1e-12);
  EXPECT_NEAR(surface.eval(i, forward_at_0).si(), 0.1, 1e-12);
  EXPECT_NEAR(surface.eval(i, mirrored(i)).si(), 0.1, 1e-12);
  EXPECT_NEAR(in_degrees(phase_angle(i, at_deg(30, 0))), 0.0, 1e-12);
}

TEST(HardCase, PhiIAndPhiRSwapped) {
  // Bright at phi_r - phi_i = 20 deg, and not at -20.
  const TabulatedSurface surface =
      table(rings_at_30(80.0, [](double theta, double phi) { return theta == 30.0 && phi == 20.0 ? 1.0 : 0.1; }));

  EXPECT_NEAR(surface.eval(at_deg(30, 40), at_deg(30, 60)).si(), 1.0, 1e-9);
  EXPECT_NEAR(surface.eval(at_deg(30, 60), at_deg(30, 40)).si(), 0.1, 1e-9);
}

TEST(HardCase, ThetaTo90IsNotMeasured) {
  // What an arm cannot reach has its share of the cosine: 6.7 % beyond 75 deg, 3.0 % beyond 80, 0.76 % beyond 85.
  for (const double last : {75.0, 80.0, 85.0}) {
    std::vector<TableReading> readings = rings_at_30(70.0, [](double, double) { return 0.2; });
    for (double phi = 0.0; phi < 360.0; phi += 10.0) readings.push_back(reading(30, last, phi, 0.2));
    const double share = std::cos(degrees(last).si()) * std::cos(degrees(last).si());

    EXPECT_NEAR(table(readings).extrapolated_share(at_deg(30)), share, 0.004) << last;
    EXPECT_FALSE(table(readings).covers(at_deg(30), at_deg(last + 1.0)));
  }
}

TEST(HardCase, NearZeroNetSignal) {
  // A black sample: noise of 0.01 about 0. Clipped at 0 every reading is 0.4 sigma too high on average, and so is the
  // integral of many of them.
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  std::mt19937_64 engine(kSeed);
  std::normal_distribution<double> noise(0.0, 0.01);
  const std::vector<TableReading> readings = rings_at_30(80.0, [&](double, double) { return noise(engine); });
  std::vector<TableReading> clipped = readings;
  for (TableReading& r : clipped) r.f.value = std::max(r.f.value, Brdf());

  const double ours = rho_dh(Surface(table(readings)), at_deg(30), 1e-3).value / (kPi * 0.01);
  const double naive = rho_dh(Surface(table(clipped)), at_deg(30), 1e-3).value / (kPi * 0.01);

  // In sigmas of one reading; the mean of 289 with their weights has some 0.07.
  EXPECT_NEAR(ours, 0.0, 0.28);
  EXPECT_NEAR(naive - 0.3989, 0.0, 0.28);
  EXPECT_GT(naive, 0.2);
}

TEST(HardCase, NearZeroWeightsFromTheValue) {
  // Repeated readings of one direction, 1 +- 0.3. A weight of 1/u^2 with u from the value itself, as 10 % of it,
  // favours the low ones; the u of a model does not.
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  std::mt19937_64 engine(kSeed);
  std::uniform_real_distribution<double> spread(0.5, 1.5);
  std::vector<TableReading> by_model = rings_at_30(80.0, [](double, double) { return 1.0; });
  std::vector<TableReading> by_value = by_model;
  for (int k = 0; k < 1000; ++k) {
    const double f = spread(engine);
    by_model.push_back(reading(30, 0, 0, f, 0.3));
    by_value.push_back(reading(30, 0, 0, f, 0.1 * f));
  }
  for (auto* readings : {&by_model, &by_value}) readings->front().f.u = per_steradian(0.3);

  EXPECT_NEAR(table(by_model).eval(at_deg(30), at_deg(0)).si(), 1.0, 4.0 * 0.29 / std::sqrt(1000.0));
  EXPECT_LT(table(by_value).eval(at_deg(30), at_deg(0)).si(), 0.9);
}

TEST(HardCase, RpvAtGrazingInTables) {
  // 32 cells, even in mu^2, in each of which the density is taken for constant: its mean in the last one against what
  // it is within. The sampler's cells are even in sqrt(mu), and smaller where the density bends.
  const Direction i = at_deg(30);
  const double total = rho_dh(wheat(), i, 1e-9).value;
  const auto wanted = [&](double mu) {
    const Direction r = Direction::from_cosine(mu, std::sqrt(1.0 - mu * mu), degrees(90));
    return wheat().eval(i, r).si() * mu / total;
  };
  const double edge = std::sqrt(1.0 / 32.0);
  double mean = 0.0;
  for (int k = 0; k < 1000; ++k) mean += wanted(edge * std::sqrt((k + 0.5) / 1000.0)) / 1000.0;
  const auto sampler = TableSampler::make(wheat(), i).value();

  double naive_error = 0.0;
  double our_error = 0.0;
  for (const double mu : {0.2 * edge, 0.35 * edge, 0.5 * edge, 0.99 * edge}) {
    const Direction r = Direction::from_cosine(mu, std::sqrt(1.0 - mu * mu), degrees(90));
    naive_error = std::max(naive_error, std::abs(mean / wanted(mu) - 1.0));
    our_error = std::max(our_error, std::abs(sampler->density_per_sr(r) / wanted(mu) - 1.0));
  }

  EXPECT_GT(naive_error, 0.4);
  EXPECT_LT(our_error, 0.1);
  EXPECT_LE(sampler->report().total_variation, 2e-3);
}

TEST(HardCase, FresnelDeltaIsDrawn) {
  // R_F / rho_dh of all draws go exactly to the mirror direction, where a density has nothing to find.
  const Direction i = at_deg(60);
  const Surface mirror = surface("fresnel_mirror", {{"refractive_index", 1.34}});
  const Surface both(SurfaceSum::make({{wheat(), 0.2}, {mirror, 1.0}}).value());
  const auto sampler = make_sampler(both, i).value();
  const double expected = mirror.specular(i) / rho_dh(both, i, 1e-9).value;
  constexpr std::uint64_t kDraws = 20000;

  std::uint64_t specular = 0;
  for (std::uint64_t k = 0; k < kDraws; ++k) {
    const DirectionSample draw = sampler->sample(RandomStream(kSeed), k);
    if (!draw.is_specular) continue;
    ++specular;
    ASSERT_LT(in_radians(phase_angle(draw.r, mirrored(i))), 1e-12);
  }

  const double sigma = std::sqrt(expected * (1.0 - expected) / kDraws);
  EXPECT_NEAR(static_cast<double>(specular) / kDraws, expected, 4.0 * sigma) << "seed " << kSeed;
}

TEST(HardCase, NormalisingWhereRhoDhExceeds1) {
  // w_r = rho_dh w_i makes a photon grow each time that it comes by; the samplers say so and clip nothing.
  const struct {
    Surface surface;
    double theta_deg;
    bool gains;
  } rows[] = {{wheat(), 89.9, true}, {wheat(), 60.0, false}, {surface("hapke", {{"omega0", 1.0}}), 0.0, true},
              {sea(), 89.0, true},   {sea(), 60.0, false},   {surface("hapke", {{"omega0", 0.99}}), 0.0, false}};
  for (const auto& row : rows) {
    SCOPED_TRACE(::testing::Message() << row.surface.model() << " at " << row.theta_deg);
    const Direction i = at_deg(row.theta_deg);
    const double rho = rho_dh(row.surface, i, 1e-6).value;
    double naive_weight = 1.0;
    for (int bounce = 0; bounce < 100; ++bounce) naive_weight *= rho;

    const auto sampler = make_sampler(row.surface, i).value();

    EXPECT_EQ(naive_weight > 1.0, row.gains);
    EXPECT_EQ(sampler->report().gains_energy(), row.gains);
    EXPECT_NEAR(sampler->report().rho_dh, rho, 1e-5 * rho);
  }
}

}  // namespace
}  // namespace gonio::reflectance
