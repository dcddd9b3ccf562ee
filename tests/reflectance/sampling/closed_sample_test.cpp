#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "reflectance/integral/directional_reflectance.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;

constexpr std::uint64_t kSeed = 20260101;

double unit(std::mt19937_64& engine) {
  return static_cast<double>(engine() >> 11) * 0x1p-53;
}

// Chi-square of counts over equal shares of the distribution function: rows of mu^(k+2), columns of phi.
double chi_square(const Surface& s, double k, int draws) {
  constexpr std::size_t kRows = 32;
  constexpr std::size_t kColumns = 16;
  std::mt19937_64 engine(kSeed);
  std::vector<double> counts(kRows * kColumns);
  const Direction i = Direction::from_angles(60.0_deg, {});
  for (int n = 0; n < draws; ++n) {
    const double u = unit(engine);
    const Direction r = s.closed_sample(i, {.u = u, .v = unit(engine)})->r;
    const auto row = static_cast<std::size_t>(std::pow(r.mu(), k + 2.0) * (kRows - 1e-9));
    const auto column = static_cast<std::size_t>((in_degrees(r.phi()) + 180.0) / 360.0 * (kColumns - 1e-9));
    counts[row * kColumns + column] += 1.0;
  }
  const double expected = static_cast<double>(draws) / (kRows * kColumns);
  double sum = 0.0;
  for (const double count : counts) sum += (count - expected) * (count - expected) / expected;
  return sum;
}

TEST(ClosedSample, FollowsTheDistributionFunctionOfTheModel) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  // 511 degrees of freedom: 4 standard deviations of 32 above the mean.
  EXPECT_LT(chi_square(surface("lambertian", {{"rho", 0.5}}), 0.0, 200000), 511.0 + 4.0 * 32.0);
  EXPECT_LT(chi_square(surface("minnaert", {{"rho", 0.5}, {"k", 0.5}}), 0.5, 200000), 511.0 + 4.0 * 32.0);
  EXPECT_LT(chi_square(surface("minnaert", {{"rho", 0.5}, {"k", -0.5}}), -0.5, 200000), 511.0 + 4.0 * 32.0);
}

TEST(ClosedSample, WeighsEachDirectionByRhoDhOverItsShare) {
  // weight x density = f mu_r, with the density (k + 2) mu^(k+1) / (2 pi) of the inverse.
  const Surface s = surface("minnaert", {{"rho", 0.5}, {"k", 0.5}});
  const Direction i = Direction::from_angles(40.0_deg, {});
  for (const double u : {0.001, 0.3, 0.8, 1.0}) {
    const DirectionSample sample = *s.closed_sample(i, {.u = u, .v = 0.7});

    EXPECT_DOUBLE_EQ(sample.r.mu(), std::pow(u, 1.0 / 2.5));
    const double density = 2.5 * std::pow(sample.r.mu(), 1.5) / (2.0 * std::numbers::pi);
    EXPECT_NEAR(sample.weight * density / (s.eval(i, sample.r).si() * sample.r.mu()), 1.0, 1e-14);
    EXPECT_EQ(sample.weight, rho_dh(s, i).value);
    EXPECT_FALSE(sample.is_specular);
  }
}

TEST(ClosedSample, IsFiniteAtTheEndsOfTheDraw) {
  for (const double k : {-0.5, 0.0, 0.5}) {
    const Surface s = surface("minnaert", {{"rho", 0.5}, {"k", k}});
    EXPECT_EQ(s.closed_sample(Direction(), {.u = 0.0, .v = 0.0})->r.mu(), 0.0);
    EXPECT_EQ(s.closed_sample(Direction(), {.u = 1.0, .v = 1.0})->r, Direction());
  }
}

TEST(ClosedSample, OfAMirrorIsItsMirrorDirectionWithTheShareOfFresnel) {
  const Surface s = surface("fresnel_mirror", {{"refractive_index", 1.34}});
  const Direction i = Direction::from_angles(60.0_deg, 20.0_deg);

  const DirectionSample sample = *s.closed_sample(i, {.u = 0.3, .v = 0.4});

  EXPECT_EQ(sample.r, mirrored(i));
  EXPECT_EQ(sample.weight, s.specular(i));
  EXPECT_TRUE(sample.is_specular);
}

TEST(ClosedSample, IsNotOfferedWithoutAnInverse) {
  EXPECT_FALSE(wheat().closed_sample(Direction(), {.u = 0.3, .v = 0.4}));
}

}  // namespace
}  // namespace gonio::reflectance
