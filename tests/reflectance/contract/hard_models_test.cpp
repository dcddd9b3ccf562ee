// Where the textbook form of a model fails and ours must hold. Each test shows both; its name is the case's.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "reflectance/check/hard_pairs.h"
#include "reflectance/check/reciprocity_gap.h"
#include "reflectance/surface/fresnel.h"
#include "reflectance/surface/hapke.h"
#include "reflectance/surface/henyey_greenstein.h"
#include "tests/reflectance/contract/oracle.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

double relative_error(double computed, double truth) {
  return std::abs(computed / truth - 1.0);
}

struct PeakRow {
  double g;
  OracleDirection i;
  OracleDirection r;
  double phase;
};

const PeakRow kPeaks[] = {
#include "tests/reflectance/contract/oracle_phase_peaks.inc"
};

double naive_henyey_greenstein(double g, const Direction& i, const Direction& r) {
  const double cosine = i.mu() * r.mu() + i.sin_theta() * r.sin_theta() * std::cos(i.phi().si() - r.phi().si());
  return (1.0 - g * g) / std::pow(1.0 + g * g + 2.0 * g * cosine, 1.5);
}

TEST(HardCase, OthgAsGTendsTo1) {
  for (const PeakRow& row : kPeaks) {
    SCOPED_TRACE(::testing::Message() << "g " << row.g << ", " << row.i << ", " << row.r);
    const Direction i = row.i.direction();
    const Direction r = row.r.direction();
    // g is a double 1e-6 from 1, and 1 - |g| is exact: nothing but roundings is left.
    EXPECT_TRUE(is_within(HenyeyGreenstein(row.g)(i, r, separation_terms(i, r)), row.phase, 1e-14));
    EXPECT_FALSE(relative_error(naive_henyey_greenstein(row.g, i, r), row.phase) < 1e-9);  // NaN and infinity fail too
  }
}

struct HapkeLimitRow {
  int a;
  double co_albedo;
  double mu;
  double rho_dh;
};

const HapkeLimitRow kHapkeLimits[] = {
#include "tests/reflectance/contract/oracle_hapke_limits.inc"
};

// Textbook partial fractions for the integral of eq 7.
double naive_hapke_rho_dh(double mu, double a, double omega0, double gamma) {
  const double b = 2.0 * gamma;
  const double l1 = std::log(1.0 + b) / b;
  const double l2 = (1.0 - l1) / b;
  const double j = ((1.0 - a * mu) * std::log((1.0 + mu) / mu) + (a - b) * l1) / (1.0 - b * mu);
  return 0.5 * omega0 * (1.0 + a * mu) / (1.0 + b * mu) * (l1 + a * l2 - mu * j);
}

double our_hapke_rho_dh(const HapkeLimitRow& row) {
  const HapkeForm form = row.a == 2 ? HapkeForm::Hapke : HapkeForm::AsPrinted;
  const Surface hapke(Hapke::make_from_co_albedo(row.co_albedo, form).value());
  return hapke.closed_rho_dh(Direction::from_cosine(row.mu, std::sqrt((1.0 - row.mu) * (1.0 + row.mu)), {})).value();
}

TEST(HardCase, Omega0To1) {
  const struct {
    double co_albedo;
    double naive_error;
  } lost[] = {{1e-8, 2e-10}, {1e-12, 1e-6}, {1e-16, 1e-3}};
  for (const auto& expected : lost) {
    double naive_error = 0.0;
    for (const HapkeLimitRow& row : kHapkeLimits) {
      if (row.co_albedo != expected.co_albedo) continue;
      const double naive = naive_hapke_rho_dh(row.mu, row.a, 1.0 - row.co_albedo, std::sqrt(row.co_albedo));
      naive_error = std::max(naive_error, relative_error(naive, row.rho_dh));
      EXPECT_TRUE(is_within(our_hapke_rho_dh(row), row.rho_dh, 2e-15)) << row.co_albedo << " " << row.mu;
    }
    EXPECT_GT(naive_error, expected.naive_error) << expected.co_albedo;
  }
}

TEST(HardCase, Omega0To1LosesGamma) {
  // 1 - (1 - 1e-14) has two digits left: gamma is 4e-4 off, and so is what absorption does to the albedo.
  EXPECT_GT(relative_error(std::sqrt(1.0 - (1.0 - 1e-14)), 1e-7), 3e-4);
  for (const HapkeLimitRow& row : kHapkeLimits) {
    if (row.co_albedo != 1e-14) continue;
    EXPECT_TRUE(is_within(our_hapke_rho_dh(row), row.rho_dh, 2e-15)) << row.mu;
  }
  // As an omega0 it is a double all the same, and its own rho_dh is as good.
  const double co_albedo = 1.0 - (1.0 - 1e-14);
  const Direction pole;
  EXPECT_EQ(surface("hapke", {{"omega0", 1.0 - 1e-14}}).closed_rho_dh(pole),
            Surface(Hapke::make_from_co_albedo(co_albedo).value()).closed_rho_dh(pole));
}

TEST(HardCase, TwoGammaMu0Is1) {
  double naive_error_at_1e13 = 0.0;
  for (const HapkeLimitRow& row : kHapkeLimits) {
    if (row.co_albedo != 0.25) continue;
    EXPECT_TRUE(is_within(our_hapke_rho_dh(row), row.rho_dh, 2e-15)) << row.a << " " << row.mu;
    const double naive = naive_hapke_rho_dh(row.mu, row.a, 0.75, 0.5);
    EXPECT_EQ(std::isnan(naive), row.mu == 1.0);
    if (1.0 - row.mu == 0x1p-43) naive_error_at_1e13 = std::max(naive_error_at_1e13, relative_error(naive, row.rho_dh));
  }
  EXPECT_GT(naive_error_at_1e13, 1e-4);
}

struct CriticalRow {
  double theta;
  double n;
  double through;
};

const CriticalRow kCritical[] = {
#include "tests/reflectance/contract/oracle_critical.inc"
};

double reflectance_by_sines(double ti, double tt) {
  const double s = std::sin(ti - tt) / std::sin(ti + tt);
  const double p = std::tan(ti - tt) / std::tan(ti + tt);
  return 0.5 * (s * s + p * p);
}

TEST(HardCase, FresnelAtNormalIncidence) {
  const double n = 1.34;

  EXPECT_TRUE(is_within(fresnel(radians(0.0), n).unpolarised(), 0.0211118416246621375, 1e-15));
  EXPECT_TRUE(std::isnan(reflectance_by_sines(0.0, 0.0)));
  // Close to it the short form works again, which is why nobody notices.
  EXPECT_TRUE(is_within(reflectance_by_sines(1e-6, std::asin(std::sin(1e-6) / n)), 0.0211118416246621375, 1e-9));
}

TEST(HardCase, FresnelPastTheCriticalAngle) {
  const double n = 1.0 / 1.34;
  for (const double theta : {0.85, 1.0, 1.5}) {
    EXPECT_EQ(fresnel(radians(theta), n).s, 1.0);
    EXPECT_EQ(fresnel(radians(theta), n).p, 1.0);
    EXPECT_EQ(fresnel_transmittance(std::cos(theta), std::sin(theta), n), 0.0);
    EXPECT_TRUE(std::isnan(reflectance_by_sines(theta, std::asin(std::sin(theta) / n))));
    // A complex root is 1 only to roundings, so that 1 - R may come out below 0.
    const std::complex<double> t = std::sqrt(std::complex<double>(1.0 - std::pow(std::sin(theta) / n, 2)));
    const double by_complex = std::norm((std::cos(theta) - n * t) / (std::cos(theta) + n * t));
    EXPECT_NEAR(by_complex, 1.0, 1e-14);
  }
}

TEST(HardCase, FresnelNearTheExactCriticalAngle) {
  double worst_naive = 0.0;
  for (const CriticalRow& row : kCritical) {
    const double ours = fresnel(radians(row.theta), row.n).unpolarised();
    // T goes with the root of the distance d from the critical angle, of which asin(n) and n leave some 2e-16.
    const double distance = std::max(std::asin(row.n) - row.theta, 0.0);
    EXPECT_NEAR(1.0 - ours, row.through, 1e-15 + (distance > 0.0 ? row.through * 2e-16 / distance : 2e-7)) << row.theta;

    const double t = std::sqrt(1.0 - std::pow(std::sin(row.theta) / row.n, 2));
    const double c = std::cos(row.theta);
    const double s = (c - row.n * t) / (c + row.n * t);
    const double p = (row.n * c - t) / (row.n * c + t);
    if (distance > 1e-13) worst_naive = std::max(worst_naive, std::abs(0.5 * (s * s + p * p) - 1.0 + row.through));
  }
  EXPECT_GT(worst_naive, 1e-10);
  EXPECT_EQ(fresnel(radians(std::nextafter(std::asin(1.0 / 1.34), 2.0)), 1.0 / 1.34).unpolarised(), 1.0);
}

// The order in which eq 8, eq 7 and Minnaert's formula are printed.
double naive_rpv(const Direction& i, const Direction& r) {
  const double k = 0.851;
  const double g = -0.114;
  const double bowl = std::pow(i.mu(), k - 1.0) * std::pow(r.mu(), k - 1.0) / std::pow(i.mu() + r.mu(), 1.0 - k);
  const double cosine = i.mu() * r.mu() + i.sin_theta() * std::cos(i.phi().si() - r.phi().si()) * r.sin_theta();
  const double phase = (1.0 - g * g) / std::pow(1.0 + g * g + 2.0 * g * cosine, 1.5);
  const double a = i.sin_theta() / i.mu();
  const double b = r.sin_theta() / r.mu();
  const double distance = std::sqrt(std::max(0.0, a * a + b * b - 2.0 * a * b * std::cos(i.phi().si() - r.phi().si())));
  return 0.133 * bowl * phase * (1.0 + (1.0 - 0.133) / (1.0 + distance));
}

double naive_hapke(const Direction& i, const Direction& r) {
  const double gamma = std::sqrt(0.1);
  return 0.9 / (4.0 * std::numbers::pi) / (i.mu() + r.mu()) * (1.0 + 2.0 * i.mu()) / (1.0 + 2.0 * gamma * i.mu()) *
         (1.0 + 2.0 * r.mu()) / (1.0 + 2.0 * gamma * r.mu());
}

double naive_minnaert(const Direction& i, const Direction& r) {
  return 0.5 / std::numbers::pi * std::pow(i.mu(), 0.5) * std::pow(r.mu(), 0.5);
}

TEST(HardCase, ReciprocityOfEq7Eq8AndMinnaert) {
  constexpr std::uint64_t kSeed = 4;
  const std::vector<DirectionPair> pairs = hard_pairs(20000, kSeed);
  const struct {
    Surface ours;
    double (*naive)(const Direction&, const Direction&);
  } rows[] = {{wheat(), naive_rpv},
              {surface("hapke", {{"omega0", 0.9}}), naive_hapke},
              {surface("minnaert", {{"rho", 0.5}, {"k", 0.5}}), naive_minnaert}};
  for (const auto& row : rows) {
    SCOPED_TRACE(row.ours.model());
    EXPECT_EQ(worst_reciprocity_gap(row.ours, pairs).ulps, 0U) << "seed " << kSeed;
    std::size_t differing = 0;
    for (const DirectionPair& p : pairs) differing += row.naive(p.i, p.r) != row.naive(p.r, p.i) ? 1U : 0U;
    EXPECT_GT(differing, pairs.size() / 100);
  }
}

}  // namespace
}  // namespace gonio::reflectance
