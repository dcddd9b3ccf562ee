// Simulated scans: does z mean what it says, and is a broken symmetry found?
#include "reflectance/check/symmetry_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "reflectance/check/chi_square.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

constexpr std::uint64_t kSeed = 20260412;

class Noise {
 public:
  explicit Noise(std::uint64_t seed) : engine_(seed) {}
  double normal() {  // Box and Muller: the same on every machine
    return std::sqrt(-2.0 * std::log(1.0 - unit())) * std::cos(2.0 * std::numbers::pi * unit());
  }

 private:
  double unit() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }
  std::mt19937_64 engine_;
};

enum Component : std::uint32_t { kCertificate, kZeroThetaI, kZeroThetaR };

struct Instrument {
  double certificate = 0.01;  ///< relative
  double zero_i = 0.0;        ///< [rad]
  double zero_r = 0.0;
};

// Every pair of a small grid at phi_i = 0, so that each geometry's exchange, turned, is there too. What the values say
// of themselves is true: u_random is 0.35 %, shared effects as the instrument has them.
std::vector<SymmetryPoint> scan(const Surface& truth, const Instrument& instrument, Noise& noise) {
  std::vector<SymmetryPoint> points;
  const double certificate = noise.normal();
  const double zero_i = noise.normal();
  const double zero_r = noise.normal();
  for (const double ti : {10.0, 30.0, 60.0, 75.0}) {
    for (const double tr : {10.0, 30.0, 60.0, 75.0}) {
      for (double phi = 0.0; phi < 360.0; phi += 60.0) {
        const Geometry g = geometry(ti, tr, phi);
        const double f = in_per_steradian(truth.eval(g));
        const double by_certificate = f * instrument.certificate;
        const double by_zero_i = f * instrument.zero_i * std::tan(g.theta_i.si());
        const double by_zero_r = f * instrument.zero_r * std::tan(g.theta_r.si());
        const double error =
            0.0035 * f * noise.normal() + by_certificate * certificate + by_zero_i * zero_i + by_zero_r * zero_r;
        points.push_back({.geometry = g,
                          .value = per_steradian(f + error),
                          .u_random = per_steradian(0.0035 * f),
                          .shared = {{kZeroThetaR, per_steradian(by_zero_r)},
                                     {kCertificate, per_steradian(by_certificate)},
                                     {kZeroThetaI, per_steradian(by_zero_i)}}});
      }
    }
  }
  return points;
}

SymmetryReport reciprocity(const std::vector<SymmetryPoint>& points) {
  return check_symmetry(Symmetry::Reciprocity, points, {.sameness = Sameness::Turned}).value();
}

// Kolmogorov and Smirnov's distance from the even distribution, times sqrt(n): above 2.23 with probability 1e-4.
double unevenness(std::vector<double> p) {
  std::sort(p.begin(), p.end());
  const double n = static_cast<double>(p.size());
  double worst = 0.0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    worst =
        std::max({worst, std::abs(p[k] - static_cast<double>(k) / n), std::abs(p[k] - static_cast<double>(k + 1) / n)});
  }
  return worst * std::sqrt(n);
}

TEST(SymmetryCheck, FindsThePairsOfAScanAndCountsTheRest) {
  Noise noise(kSeed);

  const SymmetryReport report = reciprocity(scan(wheat(), {}, noise));

  // 96 points; at theta_i = theta_r the azimuths 0 and 180 deg are their own exchange.
  EXPECT_EQ(report.trivial, 8u);
  EXPECT_EQ(report.gaps.size(), 44u);
  EXPECT_EQ(report.degrees_of_freedom, 44u);
  EXPECT_EQ(report.unpaired, 0u);
}

TEST(SymmetryCheck, GivesStandardNormalZAndAnEvenPForNoiseAlone) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  Noise noise(kSeed);
  std::vector<double> p;
  double sum = 0.0;
  double sum2 = 0.0;
  double outside = 0.0;
  double count = 0.0;

  for (int scans = 0; scans < 400; ++scans) {
    const SymmetryReport report = reciprocity(scan(wheat(), {}, noise));
    p.push_back(report.p_value);
    for (const SymmetryGap& gap : report.gaps) {
      sum += gap.z;
      sum2 += gap.z * gap.z;
      outside += std::abs(gap.z) > 1.959964 ? 1.0 : 0.0;
      count += 1.0;
    }
  }

  // 17600 z: four standard errors each.
  EXPECT_NEAR(sum / count, 0.0, 4.0 / std::sqrt(count));
  EXPECT_NEAR(sum2 / count, 1.0, 4.0 * std::sqrt(2.0 / count));
  EXPECT_NEAR(outside / count, 0.05, 4.0 * std::sqrt(0.05 * 0.95 / count));
  EXPECT_LT(unevenness(p), 2.23);
}

TEST(SymmetryCheck, KeepsPEvenWhenPairsErrTogether) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const Instrument instrument{.certificate = 0.03, .zero_i = 0.005, .zero_r = 0.01};
  Noise noise(kSeed);
  std::vector<double> p;
  std::vector<double> p_of_squares;
  double sum2 = 0.0;
  double count = 0.0;

  for (int scans = 0; scans < 400; ++scans) {
    const SymmetryReport report = reciprocity(scan(wheat(), instrument, noise));
    p.push_back(report.p_value);
    double squares = 0.0;
    for (const SymmetryGap& gap : report.gaps) squares += gap.z * gap.z;
    p_of_squares.push_back(chi_square_probability(squares, 44.0));
    sum2 += squares;
    count += 44.0;
  }

  EXPECT_LT(unevenness(p), 2.23);
  EXPECT_GT(unevenness(p_of_squares), 5.0);  // z alone, squared and added, takes the pairs for independent
  EXPECT_NEAR(sum2 / count, 1.0, 0.3);       // each z is right for itself; 400 scans share 400 pairs of zeros
}

TEST(SymmetryCheck, IsNotDeafenedByACertificateThatCancels) {
  // 4 % at (30, 60) alone, under a certificate of 30 % that lifts both of the pair.
  Noise noise(kSeed);
  std::vector<SymmetryPoint> points = scan(wheat(), {.certificate = 0.3}, noise);
  const Geometry broken = geometry(30, 60, 120);
  const auto at = std::find_if(points.begin(), points.end(), [&](const auto& p) { return p.geometry == broken; });
  ASSERT_NE(at, points.end());
  at->value += 0.04 * wheat().eval(broken);

  const SymmetryReport report = reciprocity(points);

  EXPECT_LT(report.p_value, 1e-4);  // z = 8 adds some 64 to the 44 of noise alone
  ASSERT_NE(report.worst(), nullptr);
  EXPECT_EQ(points[report.worst()->first].geometry, broken);
  EXPECT_EQ(points[report.worst()->second].geometry, geometry(60, 30, 240));
  EXPECT_GT(report.worst()->z, 5.0);
}

// Mobley's eq 4 broken by 4 % at 30/60, as by a shape model that was fitted for one direction only.
struct OneWay {
  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    const double slope = 0.08 * (i.mu() - r.mu()) / (std::sqrt(0.75) - 0.5) * 0.5;
    return per_steradian(0.3 * (1.0 + 0.5 * slope));
  }
  [[nodiscard]] std::string_view model() const { return "one_way"; }
  [[nodiscard]] Parameters parameters() const { return {}; }
  [[nodiscard]] bool is_isotropic() const { return true; }
};

TEST(SymmetryCheck, FindsASurfaceThatBreaksReciprocityByFourPercentAtThirtyAndSixty) {
  const Direction i = Direction::from_angles(degrees(30), {});
  const Direction r = Direction::from_angles(degrees(60), {});
  ASSERT_NEAR(OneWay{}.eval(i, r) / OneWay{}.eval(r, i), 1.04, 0.001);
  Noise noise(kSeed);

  const SymmetryReport report = reciprocity(scan(OneWay{}, {}, noise));

  EXPECT_LT(report.p_value, 1e-12);
  EXPECT_GT(std::abs(report.worst()->z), 5.0);
}

// Brighter to the left by `left`, and along phi_i = 0 by `brush`.
struct Lopsided {
  double left = 0.0;
  double brush = 0.0;
  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    const double dphi = azimuth_difference(i, r).si();
    return per_steradian(0.2 * (1.0 + left * std::sin(dphi) + brush * std::cos(2.0 * i.phi().si())));
  }
  [[nodiscard]] std::string_view model() const { return "lopsided"; }
  [[nodiscard]] Parameters parameters() const { return {}; }
  [[nodiscard]] bool is_isotropic() const { return false; }
};

TEST(SymmetryCheck, TellsLeftFromRight) {
  Noise noise(kSeed);
  const std::vector<SymmetryPoint> even = scan(Lopsided{}, {}, noise);
  const std::vector<SymmetryPoint> lopsided = scan(Lopsided{.left = 0.01}, {}, noise);

  const SymmetryReport even_report = check_symmetry(Symmetry::LeftRight, even).value();
  const SymmetryReport report = check_symmetry(Symmetry::LeftRight, lopsided).value();

  EXPECT_EQ(report.trivial, 32u);  // in the plane of incidence
  EXPECT_EQ(report.gaps.size(), 32u);
  EXPECT_GT(even_report.p_value, 1e-3);
  EXPECT_LT(report.p_value, 1e-6);
}

// One geometry under four turns of the sample, many times.
SymmetryReport turned_scan(const Surface& truth, Noise& noise) {
  std::vector<SymmetryPoint> points;
  for (const double theta_r : {0.0, 20.0, 40.0}) {
    for (const double turn : {0.0, 45.0, 90.0, 135.0}) {
      const Geometry g{
          .theta_i = degrees(30), .phi_i = degrees(turn), .theta_r = degrees(theta_r), .phi_r = degrees(turn + 200.0)};
      const double f = in_per_steradian(truth.eval(g));
      points.push_back({.geometry = g,
                        .value = per_steradian(f * (1.0 + 0.0035 * noise.normal())),
                        .u_random = per_steradian(0.0035 * f),
                        .shared = {}});
    }
  }
  return check_symmetry(Symmetry::Turn, points).value();
}

TEST(SymmetryCheck, FindsAGrainOfTheSampleByTurningIt) {
  Noise noise(kSeed);

  const SymmetryReport report = turned_scan(Lopsided{.brush = 0.01}, noise);

  EXPECT_EQ(report.degrees_of_freedom, 9u);  // three groups of four
  EXPECT_LT(report.p_value, 1e-4);
}

TEST(SymmetryCheck, GivesAnEvenPForGroupsOfTurns) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  Noise noise(kSeed);
  std::vector<double> p;

  for (int scans = 0; scans < 1000; ++scans) p.push_back(turned_scan(wheat(), noise).p_value);

  EXPECT_LT(unevenness(p), 2.23);
}

TEST(SymmetryCheck, SaysNothingOfNoPairs) {
  const SymmetryReport report = check_symmetry(Symmetry::Reciprocity, {}).value();

  EXPECT_EQ(report.worst(), nullptr);
  EXPECT_EQ(report.degrees_of_freedom, 0u);
  EXPECT_EQ(report.p_value, 1.0);
}

TEST(SymmetryCheck, RefusesNumbersThatAreNoneAndSaysOfWhichPoint) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const SymmetryPoint good{
      .geometry = geometry(30, 60, 0), .value = per_steradian(0.1), .u_random = per_steradian(0.01)};
  const auto refused = [&](const std::function<void(SymmetryPoint&)>& spoil) {
    std::vector<SymmetryPoint> points{good, good};
    spoil(points[1]);
    const Result<SymmetryReport> report = check_symmetry(Symmetry::Reciprocity, points);
    return !report && report.error().code == ErrorCode::InvalidInput &&
           report.error().tried.find("point 1") != std::string::npos;
  };

  for (const double bad : {nan, inf, -inf}) {
    EXPECT_TRUE(refused([&](SymmetryPoint& p) { p.value = per_steradian(bad); })) << bad;
    EXPECT_TRUE(refused([&](SymmetryPoint& p) { p.u_random = per_steradian(bad); })) << bad;
    EXPECT_TRUE(refused([&](SymmetryPoint& p) { p.shared = {{0, per_steradian(bad)}}; })) << bad;
  }
  EXPECT_TRUE(refused([&](SymmetryPoint& p) { p.u_random = per_steradian(0.0); }));
  EXPECT_TRUE(refused([&](SymmetryPoint& p) { p.u_random = per_steradian(-0.01); }));
  EXPECT_FALSE(refused([&](SymmetryPoint& p) { p.value = per_steradian(-0.1); }));
}

}  // namespace
}  // namespace gonio::reflectance
