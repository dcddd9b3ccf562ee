// Whether the error that comes with a value covers what is wrong with it, over generated cases with known answers.
#include <gtest/gtest.h>

#include <cmath>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/light/lit_reflectance.h"
#include "tests/reflectance/generated.h"
#include "tests/reflectance/light/lights.h"
#include "tests/reflectance/light/lit_expectation.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

TEST(ErrorEstimate, CoversTheErrorOfRUnderPowersOfTheCosine) {
  constexpr std::uint64_t kSeed = 20'05;
  GeneratedDirections chance(kSeed);
  for (int k = 0; k < 300; ++k) {
    SCOPED_TRACE(::testing::Message() << "case " << k << ", seed " << kSeed);
    const double bend = 2.0 * chance.unit();
    const double power = 6.0 * chance.unit();
    const FormulaSky sky{.formula = [=](const Direction& i) { return std::pow(i.mu(), power); },
                         .depends_on_theta_only = chance.unit() < 0.5};
    const Surface minnaert = surface("minnaert", {{"rho", 0.6}, {"k", bend}});

    const auto r = hemispherical_reflectance(minnaert, sky, std::pow(10.0, -2.0 - 8.0 * chance.unit()));

    // rho_dh = 1.2 mu^k/(k + 2).
    expect_close(r, 1.2 / (bend + 2.0) * (power + 2.0) / (power + bend + 2.0), 1.0);
  }
}

TEST(ErrorEstimate, CoversTheErrorOfLrUnderSunsAndSkies) {
  constexpr std::uint64_t kSeed = 1942;
  GeneratedDirections chance(kSeed);
  for (int k = 0; k < 6; ++k) {
    SCOPED_TRACE(::testing::Message() << "case " << k << ", seed " << kSeed);
    const Surface seen = k % 2 == 0
                             ? wheat()
                             : surface("glint_smith", {{"slope_variance", std::pow(10.0, -1.0 - 2.0 * chance.unit())},
                                                       {"refractive_index", 1.34}});
    const double theta = 75.0 * chance.unit();
    const Direction r = Direction::from_angles(degrees(75.0 * chance.unit()), degrees(360.0 * chance.unit()));
    const Light clear = CieSky::make(12, Direction::from_angles(degrees(theta), degrees(30.0)), 1.0).value();

    for (const Light& light : {Light(sun(theta, 30.0, 1.0)), clear, Light(patchy_sky())}) {
      const Result<LitIntegral> close = reflected_radiance(seen, light, r, 1e-4);
      const Result<LitIntegral> rough = reflected_radiance(seen, light, r, 1e-2);
      EXPECT_LE(std::abs(rough->value - close->value), rough->error + close->error) << seen.model();
    }
  }
}

TEST(ErrorEstimate, HoldsForTheSameSkyByDifferentMethods) {
  // A uniform sky as a table is integrated cell by cell, as a formula with a bright point about two points.
  const Light rings = UniformSky::make(1.0).value();
  const Light cells = TableSky::make({degrees(0.0), degrees(50.0), degrees(90.0)}, {degrees(0.0), degrees(100.0)},
                                     std::vector<double>(6, 1.0))
                          .value();
  const Light pointed = FormulaSky{.formula = [](const Direction&) { return 1.0; },
                                   .pointed_at = Direction::from_angles(degrees(20.0), degrees(-60.0))};
  for (const double theta : {0.0, 35.0, 80.0}) {
    const Direction r = Direction::from_angles(degrees(theta), degrees(100.0));
    const double expected = rho_hd(wheat(), r, 1e-12).value;
    for (const Light& light : {rings, cells, pointed}) {
      SCOPED_TRACE(::testing::Message() << "theta " << theta << ", " << light.parts()[0].source.index());
      expect_close(reflected_radiance(wheat(), light, r, 1e-6), expected, 1e-6, 1e-12);
    }
  }
}

}  // namespace
}  // namespace gonio::reflectance
