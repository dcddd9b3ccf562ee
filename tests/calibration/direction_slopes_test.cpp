#include "calibration/direction_slopes.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "tests/calibration/scan_builder.h"

namespace gonio::calibration {
namespace {

constexpr std::size_t kI = 0;
constexpr std::size_t kR = 1;
constexpr std::size_t kPhi = 2;

using Surface = std::function<double(double theta_i, double theta_r, double phi)>;  // radians

std::vector<SlopePoint> measured(const std::vector<Geometry>& places, const Surface& f, double u = 0.0) {
  std::vector<SlopePoint> points;
  for (const Geometry& g : places) {
    points.push_back({.planned = g,
                      .reported = g,
                      .wavelength = nanometres(568.0),
                      .value = per_steradian(f(g.theta_i.si(), g.theta_r.si(), g.phi_r.si())),
                      .u_random = per_steradian(u)});
  }
  return points;
}

std::vector<Geometry> grid(const std::vector<double>& theta_i, const std::vector<double>& theta_r,
                           const std::vector<double>& phi) {
  std::vector<Geometry> places;
  for (const double i : theta_i) {
    for (const double r : theta_r) {
      for (const double p : phi) places.push_back(directions(i, r, p));
    }
  }
  return places;
}

std::vector<DirectionSlopes> slopes_of(const std::vector<SlopePoint>& points) {
  const SlopeField field(points, true);
  std::vector<DirectionSlopes> slopes;
  for (std::size_t n = 0; n < points.size(); ++n) slopes.push_back(field.at(n));
  return slopes;
}

TEST(DirectionSlopes, AreExactForAnExponentialOfAQuarticAlongALine) {
  const auto f = [](double, double r, double) { return 0.2 * std::exp(0.3 * r - 0.7 * r * r + 0.5 * std::pow(r, 4)); };
  const auto points = measured(grid({30}, {20, 30, 40, 50, 60}, {90}), f);

  const auto slopes = slopes_of(points);

  for (std::size_t n = 0; n < points.size(); ++n) {
    const double r = points[n].reported.theta_r.si();
    const double expected = points[n].value.si() * (0.3 - 1.4 * r + 2.0 * std::pow(r, 3));
    EXPECT_NEAR(slopes[n].slope[kR], expected, slopes[n].unresolved[kR] + 1e-12);
    EXPECT_LT(slopes[n].unresolved[kR], 0.05);
    EXPECT_TRUE(slopes[n].has_neighbours[kR]);
  }
}

// Smooth but no polynomial, and sampled hardly more than once a lobe width: what is said to be unresolved must be of
// the size of what is missed, or the zeros of the arms would be trusted too far.
TEST(DirectionSlopes, SayHowMuchTheirPointsDoNotResolve) {
  const auto f = [](double i, double r, double p) {
    const double tilt2 = i * i + r * r + 2.0 * i * r * std::cos(p);  // a lobe about the mirror direction
    return 0.02 + std::exp(-tilt2 / 0.2);
  };
  const auto points = measured(grid({10, 25, 40, 55}, {5, 20, 35, 50, 65}, {0, 30, 60, 90, 120, 150, 180}), f);

  const auto slopes = slopes_of(points);

  constexpr double kStep = 1e-5;
  constexpr double kNoMatter = 0.2;  // per radian: through a zero error of 0.02 deg, 7e-5 of the value
  double missed2 = 0.0;
  double unresolved2 = 0.0;
  int within_twice = 0;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const double i = points[n].reported.theta_i.si();
    const double r = points[n].reported.theta_r.si();
    const double p = points[n].reported.phi_r.si();
    const std::array<double, 3> real = {(f(i + kStep, r, p) - f(i - kStep, r, p)) / (2.0 * kStep),
                                        (f(i, r + kStep, p) - f(i, r - kStep, p)) / (2.0 * kStep),
                                        (f(i, r, p + kStep) - f(i, r, p - kStep)) / (2.0 * kStep)};
    for (const std::size_t a : {kI, kR, kPhi}) {
      const double missed = slopes[n].slope[a] - real[a];
      missed2 += missed * missed;
      unresolved2 += slopes[n].unresolved[a] * slopes[n].unresolved[a];
      if (std::abs(missed) <= 2.0 * slopes[n].unresolved[a] + kNoMatter * points[n].value.si()) ++within_twice;
    }
  }
  EXPECT_LE(std::sqrt(missed2), std::sqrt(unresolved2));
  EXPECT_LE(std::sqrt(unresolved2), 4.0 * std::sqrt(missed2));
  EXPECT_GE(within_twice, 0.93 * 3.0 * static_cast<double>(points.size()));
}

// A narrow gloss, its readings scattered as a warped grid lays them: none on a line with another.
TEST(DirectionSlopes, OfALonePointOnTheFlankOfALobeAreOfTheSizeThatItsNeighboursSay) {
  constexpr double kWidth = 0.028;  // 1.6 deg
  const auto f = [](double, double r, double p) {
    const double off =
        (r - std::numbers::pi / 3.0) * (r - std::numbers::pi / 3.0) + 0.75 * std::pow(p - std::numbers::pi, 2);
    return 0.1 + 60.0 * std::exp(-off / (2.0 * kWidth * kWidth));
  };
  const std::vector<Geometry> places = {directions(60, 64.3, 181.6), directions(60, 63.2, 180.9),
                                        directions(60, 62.1, 182.5), directions(60, 60.4, 180.2),
                                        directions(60, 65.1, 183.0), directions(30, 64.0, 181.7)};
  const auto points = measured(places, f, 1e-4);

  const DirectionSlopes slopes = slopes_of(points)[0];

  const double r = points[0].reported.theta_r.si();
  const double p = points[0].reported.phi_r.si();
  const double real = std::abs(f(0, r + 1e-5, p) - f(0, r - 1e-5, p)) / 2e-5;
  EXPECT_FALSE(slopes.has_neighbours[kR]);
  EXPECT_EQ(slopes.slope[kR], 0.0);
  EXPECT_GT(slopes.unresolved[kR], 0.5 * real);
  EXPECT_LT(slopes.unresolved[kR], 2.0 * real);
  EXPECT_GT(real, 5.0 * points[0].value.si()) << "what |f| per radian would miss";
}

// Repeated readings of a matt surface: their noise over a small arc is no slope.
TEST(DirectionSlopes, OfALonePointDoNotComeFromNoise) {
  const auto points = measured(
      {directions(60, 40.0, 90.0), directions(60, 40.1, 90.2), directions(60, 39.9, 90.1)},
      [](double, double, double p) { return 0.3 + 1e-6 * p; }, 1e-3);

  EXPECT_DOUBLE_EQ(slopes_of(points)[0].unresolved[kR], points[0].value.si());
}

// A glint (Beckmann's facets: ln f falls with tan^2 of their tilt) on a dark ground, azimuths 20 to 45 deg apart: what
// a fit subtracts for the zero of phi_r hangs on these slopes.
TEST(DirectionSlopes, AlongPhiOfAGlintAreAsFarOffAsTheySay) {
  const auto f = [](double i, double r, double p) {
    const double sum2 = std::pow(std::cos(i) + std::cos(r), 2);
    const double cos_xi = std::cos(i) * std::cos(r) + std::sin(i) * std::sin(r) * std::cos(p);
    const double tan2 = 2.0 * (1.0 + cos_xi) / sum2 - 1.0;
    return 0.006 + 0.05 * std::exp(-tan2 / 0.054);
  };
  for (const auto& phis : {std::vector<double>{90, 135, 160, 180}, std::vector<double>{0, 30, 60, 90, 120, 150, 180}}) {
    const auto points = measured(grid({15, 30, 50}, {10, 20, 30, 40, 50, 60}, phis), f);
    const auto slopes = slopes_of(points);
    double missed2 = 0.0;
    double unresolved2 = 0.0;
    double all2 = 0.0;
    for (std::size_t n = 0; n < points.size(); ++n) {
      const Geometry& g = points[n].reported;
      const double p = g.phi_r.si();
      const double real =
          (f(g.theta_i.si(), g.theta_r.si(), p + 1e-5) - f(g.theta_i.si(), g.theta_r.si(), p - 1e-5)) / 2e-5;
      missed2 += std::pow(slopes[n].slope[kPhi] - real, 2);
      unresolved2 += std::pow(slopes[n].unresolved[kPhi], 2);
      all2 += real * real;
    }
    EXPECT_LE(missed2, unresolved2) << phis.size() << " azimuths";
    EXPECT_LE(missed2, 0.04 * all2) << phis.size() << " azimuths";
  }
}

TEST(DirectionSlopes, GoThroughTheNormalIntoTheOppositeHalfPlane) {
  const auto f = [](double, double r, double p) { return std::exp(0.4 * r * std::cos(p)); };  // along x
  const auto points = measured(grid({30}, {0, 20, 40}, {0, 180}), f);

  const auto slopes = slopes_of(points);

  EXPECT_NEAR(slopes[0].slope[kR], 0.4, 1e-12);  // at the normal, towards phi = 0
  EXPECT_NEAR(slopes[0].unresolved[kR], 0.0, 1e-12);
}

TEST(DirectionSlopes, VanishByMirrorSymmetryInThePlaneOfIncidence) {
  const auto f = [](double, double, double p) { return 1.0 + 0.3 * std::cos(p); };
  const auto points = measured(grid({30}, {40}, {0, 60, 120, 180}), f);

  const auto slopes = slopes_of(points);

  for (const std::size_t n : {0U, 3U}) {
    EXPECT_EQ(slopes[n].slope[kPhi], 0.0);
    EXPECT_EQ(slopes[n].unresolved[kPhi], 0.0);
  }
  EXPECT_NEAR(slopes[1].slope[kPhi], -0.3 * std::sin(std::numbers::pi / 3.0), slopes[1].unresolved[kPhi] + 1e-3);
}

TEST(DirectionSlopes, OfNegativeAzimuthsAreThoseOfTheMirrorImageTurnedRound) {
  const auto f = [](double i, double r, double p) { return std::exp(0.3 * i + 0.5 * r) * (1.0 + 0.3 * std::cos(p)); };
  const auto right = slopes_of(measured(grid({10, 30}, {20, 40}, {30, 60, 100}), f));
  const auto left = slopes_of(measured(grid({10, 30}, {20, 40}, {-30, -60, -100}), f));

  for (std::size_t n = 0; n < right.size(); ++n) {
    EXPECT_NEAR(left[n].slope[kI], right[n].slope[kI], 1e-12);
    EXPECT_NEAR(left[n].slope[kR], right[n].slope[kR], 1e-12);
    EXPECT_NEAR(left[n].slope[kPhi], -right[n].slope[kPhi], 1e-12);
  }
}

TEST(DirectionSlopes, AreTakenFromTheValuesThemselvesWhereTheyAreNotClearOfZero) {
  const auto f = [](double, double r, double) { return 1e-3 * (r - 0.6); };
  const auto points = measured(grid({30}, {20, 30, 40, 50}, {90}), f, 1e-6);

  const auto slopes = slopes_of(points);

  for (const DirectionSlopes& s : slopes) EXPECT_NEAR(s.slope[kR], 1e-3, 1e-12);
}

TEST(DirectionSlopes, AreGuessedAndSaidToBeGuessedWithoutNeighbours) {
  const auto f = [](double, double r, double) { return std::exp(2.0 * r); };
  const auto line = slopes_of(measured(grid({30}, {20, 30, 40}, {90}), f));
  const auto alone = slopes_of(measured(grid({30}, {40}, {90}), f));

  const double slope = std::hypot(line[1].slope[kR], line[1].unresolved[kR]);
  EXPECT_FALSE(line[1].has_neighbours[kI]);
  EXPECT_EQ(line[1].slope[kI], 0.0);
  EXPECT_DOUBLE_EQ(line[1].unresolved[kI], slope);
  EXPECT_NEAR(line[1].unresolved[kPhi], slope * std::sin(30.0 * std::numbers::pi / 180.0), 1e-12);
  EXPECT_DOUBLE_EQ(alone[0].unresolved[kR], std::exp(2.0 * 40.0 * std::numbers::pi / 180.0));
}

TEST(DirectionSlopes, AreNotTakenForZeroBecauseAPointMirrorsItself) {
  const auto f = [](double, double r, double) { return std::exp(r); };

  const auto slopes = slopes_of(measured(grid({0}, {20}, {0}), f));

  EXPECT_FALSE(slopes[0].has_neighbours[kR]);
  EXPECT_GT(slopes[0].unresolved[kR], 0.0);
}

TEST(DirectionSlopes, NeverMixWavelengths) {
  const auto f = [](double, double r, double) { return std::exp(r); };
  auto points = measured(grid({30}, {20, 40}, {90}), f);
  points[1].wavelength = nanometres(632.8);

  const auto slopes = slopes_of(points);

  EXPECT_FALSE(slopes[0].has_neighbours[kR]);
}

// A glint through three theta_i and two phi of a lobe's width of theta_r: what is said to be missed of the bends along
// the short lines is of the size of what is missed, not of the bends themselves.
TEST(DirectionSlopes, WhatThreePointsMissOfABendIsJudgedByTheLineThatHasFive) {
  const auto f = [](double i, double r, double p) {
    const double tilt2 = i * i + r * r + 2.0 * i * r * std::cos(p);
    return 0.02 + std::exp(-tilt2 / 0.2);
  };
  const auto points = measured(grid({25, 30, 35}, {20, 25, 30, 35, 40, 45}, {170, 180}), f);

  const auto slopes = slopes_of(points);

  constexpr double kStep = 1e-4;
  for (const std::size_t a : {kI, kPhi}) {
    double missed2 = 0.0, unresolved2 = 0.0, bend2 = 0.0;
    for (std::size_t n = 0; n < points.size(); ++n) {
      const auto at = [&](double step) {
        const Geometry& g = points[n].reported;
        return f(g.theta_i.si() + (a == kI ? step : 0.0), g.theta_r.si(), g.phi_r.si() + (a == kPhi ? step : 0.0));
      };
      const double real = (at(kStep) - 2.0 * at(0.0) + at(-kStep)) / (kStep * kStep);
      missed2 += std::pow(slopes[n].curvature[a] - real, 2);
      unresolved2 += std::pow(slopes[n].unresolved_curvature[a], 2);
      bend2 += real * real;
    }
    EXPECT_LE(std::sqrt(missed2), 1.2 * std::sqrt(unresolved2)) << a;
    EXPECT_LE(std::sqrt(unresolved2), 0.2 * std::sqrt(bend2)) << a;
  }
}

TEST(DirectionSlopes, OfABendWithoutAnyLineOfFivePointsHalfIsUnresolved) {
  const auto f = [](double, double r, double) { return std::exp(-r * r / 0.2); };

  const auto slopes = slopes_of(measured(grid({30}, {30, 35, 40}, {90}), f));

  EXPECT_DOUBLE_EQ(slopes[1].unresolved_curvature[kR], 0.5 * std::abs(slopes[1].curvature[kR]));
}

TEST(DirectionSlopes, AtThePoleAnIsotropicSampleIsFlatAcrossThePlaneOfBothDirections) {
  const auto f = [](double i, double r, double p) { return 0.2 + 0.1 * (i * std::cos(p) + r); };

  const auto slopes = slopes_of(measured(grid({30}, {0, 20, 40}, {0, 180}), f));

  EXPECT_NEAR(slopes[0].across_pole[1], 0.0, 1e-12);
}

}  // namespace
}  // namespace gonio::calibration
