#include "reflectance/fit/scan_whitening.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace gonio::fit::test {
namespace {

using reflectance::SharedEffect;
using reflectance::SharedEffects;

constexpr std::size_t kReadings = 12;
constexpr std::size_t kComponents = 4;

std::vector<std::vector<SharedEffect>> some_effects() {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal;
  std::vector<std::vector<SharedEffect>> effects(kReadings);
  for (auto& own : effects) {
    for (std::uint32_t k = 0; k < kComponents; ++k) {
      if (engine() % 3 != 0) own.push_back({10 * k, per_steradian(normal(engine))});
    }
  }
  return effects;
}

std::vector<ReadingError> errors_of(const std::vector<std::vector<SharedEffect>>& effects) {
  std::vector<ReadingError> errors;
  for (std::size_t j = 0; j < effects.size(); ++j) {
    errors.push_back({.u_random = 0.5 + 0.1 * static_cast<double>(j), .shared = SharedEffects(effects[j])});
  }
  return errors;
}

// x^T V^-1 x by Gauss's elimination of the dense V.
double dense_chi2(const std::vector<std::vector<SharedEffect>>& effects, const std::vector<double>& x) {
  const std::size_t n = x.size();
  std::vector<std::vector<double>> v(n, std::vector<double>(n + 1, 0.0));
  const auto per_sd = [&](std::size_t j, std::uint32_t component) {
    for (const SharedEffect& e : effects[j]) {
      if (e.component == component) return e.per_sd.si();
    }
    return 0.0;
  };
  for (std::size_t a = 0; a < n; ++a) {
    const double u = 0.5 + 0.1 * static_cast<double>(a);
    v[a][a] = u * u;
    v[a][n] = x[a];
    for (std::size_t b = 0; b < n; ++b) {
      for (std::uint32_t k = 0; k < kComponents; ++k) v[a][b] += per_sd(a, 10 * k) * per_sd(b, 10 * k);
    }
  }
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t row = 0; row < n; ++row) {
      if (row == k) continue;
      const double factor = v[row][k] / v[k][k];
      for (std::size_t c = k; c <= n; ++c) v[row][c] -= factor * v[k][c];
    }
  }
  double chi2 = 0.0;
  for (std::size_t k = 0; k < n; ++k) chi2 += x[k] * v[k][n] / v[k][k];
  return chi2;
}

TEST(ScanWhitening, HasTheLengthThatTheDenseCovarianceGives) {
  const auto effects = some_effects();
  const ScanWhitening whitening = ScanWhitening::make(errors_of(effects)).value();
  std::vector<double> x(kReadings);
  for (std::size_t j = 0; j < kReadings; ++j) x[j] = std::sin(1.0 + 3.0 * static_cast<double>(j));

  std::vector<double> z(whitening.size());
  whitening.whiten(x, z);
  double chi2 = 0.0;
  for (const double value : z) chi2 += value * value;

  EXPECT_NEAR(chi2 / dense_chi2(effects, x), 1.0, 1e-12);
}

TEST(ScanWhitening, FindsTheSharedErrorBehindAPatternOfIt) {
  std::vector<ReadingError> errors;
  std::vector<double> x;
  for (int j = 0; j < 50; ++j) {
    errors.push_back({.u_random = 0.01, .shared = SharedEffects({{3, per_steradian(1.0)}})});
    x.push_back(2.0);  // all readings two standard deviations of component 3 too high
  }
  const ScanWhitening whitening = ScanWhitening::make(errors).value();

  std::vector<double> z(whitening.size());
  whitening.whiten(x, z);

  EXPECT_EQ(whitening.component(0), 3U);
  EXPECT_NEAR(z[50], 2.0, 1e-4);
  EXPECT_NEAR(z[0], 0.0, 1e-3);
}

TEST(ScanWhitening, IsThePlainRatioWithoutComponents) {
  const ScanWhitening whitening =
      ScanWhitening::make(std::vector<ReadingError>{{.u_random = 2.0, .shared = {}}}).value();

  std::vector<double> z(whitening.size());
  whitening.whiten(std::vector<double>{3.0}, z);

  EXPECT_EQ(z, std::vector<double>{1.5});
}

TEST(ScanWhitening, RefusesMoreComponentsThanItCanSolveFor) {
  std::vector<ReadingError> errors;
  for (std::uint32_t k = 0; k <= 2048; ++k) {
    errors.push_back({.u_random = 1.0, .shared = SharedEffects({{k, per_steradian(1.0)}})});
  }

  EXPECT_EQ(ScanWhitening::make(errors).error().seen, "2049 shared components");
}

}  // namespace
}  // namespace gonio::fit::test
