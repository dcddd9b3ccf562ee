// What a model becomes when a parameter goes to its end, and how fast: bounds from the series of each formula.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reflectance/check/hard_pairs.h"
#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/surface/fresnel.h"
#include "reflectance/surface/hapke.h"
#include "tests/reflectance/properties/generated_surfaces.h"

namespace gonio::reflectance {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kSeed = 20260530;
constexpr double kRounding = 1e-14;  // of some ten operations

// Anywhere but within 1e-9 rad of the horizon, where models keep mu at 1e-12.
std::vector<DirectionPair> pairs() {
  std::vector<DirectionPair> all = hard_pairs(400, kSeed);
  std::erase_if(all, [](const DirectionPair& p) { return std::min(p.i.mu(), p.r.mu()) < 1e-9; });
  return all;
}

double value(const Surface& s, const DirectionPair& p) {
  return in_per_steradian(s.eval(p.i, p.r));
}

TEST(Limit, OfMinnaertIsLambertianAsKGoesToZero) {
  for (const double k : {1e-3, 1e-6, 1e-12, 1e-300, 0.0, -1e-12, -1e-3}) {
    const Surface s = surface("minnaert", {{"rho", 0.4}, {"k", k}});
    for (const DirectionPair& p : pairs()) {
      const double away = std::abs(std::expm1(k * std::log(p.i.mu() * p.r.mu())));
      EXPECT_NEAR(value(s, p) / (0.4 / kPi), 1.0, away + kRounding) << k << ", " << text_of(p.i, p.r);
    }
    EXPECT_NEAR(rho_dh(s, degrees(60)).value, 0.4, 0.4 * (1.2 * std::abs(k) + kRounding)) << k;
  }
}

// Single scattering: f -> omega0 / (4 pi (mu_i + mu_r)) H H with H of omega0 = 0.
TEST(Limit, OfHapkeIsSingleScatteringAsOmega0GoesToZero) {
  for (const char* model : {"hapke", "hapke_exact", "hapke_as_printed"}) {
    for (const double omega0 : {1e-3, 1e-6, 1e-12, 1e-300}) {
      const Surface s = surface(model, {{"omega0", omega0}});
      for (const DirectionPair& p : pairs()) {
        const auto h = [&](double mu) {
          return std::string_view(model) == "hapke_as_printed" ? (1.0 + mu) / (1.0 + 2.0 * mu) : 1.0;
        };
        const double single = omega0 / (4.0 * kPi * (p.i.mu() + p.r.mu())) * h(p.i.mu()) * h(p.r.mu());
        // H = 1 + omega0 mu/(1 + 2 mu) + ...: at most a third of omega0 more, twice; the exact H up to 0.35.
        EXPECT_NEAR(value(s, p) / single, 1.0, omega0 + kRounding)
            << model << " " << omega0 << ", " << text_of(p.i, p.r);
      }
    }
    EXPECT_EQ(value(surface(model, {{"omega0", 0.0}}), pairs().front()), 0.0);
  }
}

TEST(Limit, OfHapkesRhoDhIsThatOfSingleScattering) {
  const double omega0 = 1e-9;
  for (const double theta : {0.0, 30.0, 60.0, 89.0}) {
    const double mu = std::cos(degrees(theta).si());
    // integral of omega0 mu_r / (4 pi (mu + mu_r)) dOmega_r
    const double single = 0.5 * omega0 * (1.0 - mu * std::log1p(1.0 / mu));

    EXPECT_NEAR(rho_dh(surface("hapke", {{"omega0", omega0}}), degrees(theta)).value / single, 1.0, 2e-9);
    EXPECT_NEAR(rho_dh(surface("hapke_exact", {{"omega0", omega0}}), degrees(theta)).value / single, 1.0, 1e-6);
  }
}

TEST(Limit, OfHapkeWithoutLossIsReachedAsTheSquareRootOfTheLoss) {
  for (const HapkeForm form : {HapkeForm::Hapke, HapkeForm::AsPrinted, HapkeForm::Exact}) {
    const Surface lossless = Hapke::make_from_co_albedo(0.0, form).value();
    for (const double loss : {1e-4, 1e-8, 1e-14, 1e-30, 1e-300}) {
      const Surface s = Hapke::make_from_co_albedo(loss, form).value();
      const double gamma = std::sqrt(loss);
      for (const DirectionPair& p : pairs()) {
        // d ln H / d gamma is at most 2 mu for the forms, H(1) = 2.9 for the exact one; two of them.
        EXPECT_NEAR(value(s, p) / value(lossless, p), 1.0, 6.0 * gamma + kRounding)
            << loss << ", " << text_of(p.i, p.r);
      }
    }
  }
  // All light comes back: rho_dh = 1 - gamma H.
  for (const double loss : {1e-8, 1e-14, 0.0}) {
    const Surface s = Hapke::make_from_co_albedo(loss, HapkeForm::Exact).value();
    EXPECT_NEAR(rho_dh(s, degrees(30)).value, 1.0, 2.91 * std::sqrt(loss) + kRounding) << loss;
  }
}

TEST(Limit, OfHenyeyAndGreensteinIsIsotropicAsGGoesToZero) {
  for (const std::string model : {"hapke", "hapke_exact"}) {
    const Surface isotropic = surface(model, {{"omega0", 0.7}});
    for (const double g : {1e-3, 1e-6, -1e-6, 1e-12, 1e-300, -1e-300}) {
      const Surface s = surface(model + "_hg", {{"omega0", 0.7}, {"g", g}});
      for (const DirectionPair& p : pairs()) {
        // P = 1 - 3 g cos(xi) + ..., and H H >= 1.
        EXPECT_NEAR(value(s, p) / value(isotropic, p), 1.0, 3.1 * std::abs(g) + kRounding)
            << model << " " << g << ", " << text_of(p.i, p.r);
      }
    }
  }
}

TEST(Limit, OfRpvIsLambertianAsItsBowlAndHotSpotVanish) {
  for (const double step : {1e-3, 1e-8, 1e-14}) {
    const Surface s = surface("rpv_brf", {{"rho0", 1.0 - step}, {"k", 1.0 + step}, {"g", step}});
    for (const DirectionPair& p : pairs()) {
      const double bowl = std::log(p.i.mu() * p.r.mu() * (p.i.mu() + p.r.mu()));
      EXPECT_NEAR(value(s, p) * kPi, 1.0, step * (6.0 + 1.1 * std::abs(bowl)) + kRounding)
          << step << ", " << text_of(p.i, p.r);
    }
  }
}

TEST(Limit, OfASeaWithoutWindIsItsCapillaryRoughness) {
  for (const DirectionPair& p : pairs()) {
    const double calm = value(surface("cox_munk", {{"wind_m_per_s", 0.0}, {"refractive_index", 1.34}}), p);
    const double glint = value(surface("glint", {{"slope_variance", 0.003}, {"refractive_index", 1.34}}), p);
    EXPECT_EQ(calm, glint) << text_of(p.i, p.r);
  }
}

TEST(Limit, OfASmoothGlintIsFresnelsMirrorAndTheNextTermIsKnown) {
  // With slopes z of variance sigma^2 / 2 each, rho_dh is the mean of R_F(c) (1 + z_x tan(theta)), c = (mu + z_x sin
  // (theta)) / sqrt(1 + z^2): R_F + sigma^2 [R'(sin tan/2 - mu/2) + R'' sin^2/4], derivatives by mu with 30 digits.
  const struct {
    double theta;
    double slope;
  } rows[] = {{0.0, 0.0}, {30.0, 0.018155099}, {60.0, 0.18384795}};
  for (const auto& row : rows) {
    const double mirror = fresnel(degrees(row.theta), 1.34).unpolarised();
    for (const char* model : {"glint", "glint_smith"}) {
      for (const double variance : {1e-3, 1e-4, 1e-6}) {
        const Surface s = surface(model, {{"slope_variance", variance}, {"refractive_index", 1.34}});
        const Integral rho = rho_dh(s, degrees(row.theta), 1e-7);
        EXPECT_NEAR(rho.value, mirror + row.slope * variance, variance * variance + rho.error)
            << model << " " << variance << " at " << row.theta;
      }
    }
  }
}

TEST(Limit, OfAnIndexOfOneIsNoInterface) {
  const Surface mirror = surface("fresnel_mirror", {{"refractive_index", 1.0}});
  const Surface glint = surface("glint", {{"slope_variance", 0.05}, {"refractive_index", 1.0}});
  const Surface water = surface("water_body", {{"rho_w", 0.3}, {"refractive_index", 1.0}});
  for (const DirectionPair& p : pairs()) {
    EXPECT_EQ(mirror.specular(p.i), 0.0) << text_of(p.i, p.r);
    EXPECT_EQ(value(glint, p), 0.0) << text_of(p.i, p.r);
    EXPECT_NEAR(value(water, p), 0.3 / kPi, 1e-15) << text_of(p.i, p.r);
  }
}

TEST(Limit, OfAnInfiniteIndexIsAPerfectMirror) {
  const Surface mirror = surface("fresnel_mirror", {{"refractive_index", 1e12}});
  for (const double theta : {0.0, 45.0, 80.0}) {
    EXPECT_NEAR(mirror.specular(Direction::from_angles(degrees(theta), {})), 1.0, 4e-11) << theta;
  }
}

TEST(Limit, OfBlackWaterIsDarkness) {
  const Surface black = surface("water_body", {{"rho_w", 0.0}, {"refractive_index", 1.34}});
  for (const DirectionPair& p : pairs()) EXPECT_EQ(value(black, p), 0.0) << text_of(p.i, p.r);
  EXPECT_EQ(rho_dh(black, degrees(30)).value, 0.0);
}

TEST(Limit, OfNothingSentBackIsDarkness) {
  const Surface lambertian = surface("lambertian", {{"rho", 0.0}});
  const Surface minnaert = surface("minnaert", {{"rho", 0.0}, {"k", -0.5}});
  const Surface rpv = surface("rpv", {{"rho0", 0.0}, {"k", 0.8}, {"g", -0.1}});
  for (const Surface& s : {lambertian, minnaert, rpv}) {
    for (const DirectionPair& p : pairs()) EXPECT_EQ(value(s, p), 0.0) << s.model() << ", " << text_of(p.i, p.r);
    EXPECT_EQ(rho_dh(s, degrees(40)).value, 0.0) << s.model();
  }
}

}  // namespace
}  // namespace gonio::reflectance
