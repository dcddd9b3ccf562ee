#include "calibration/line_derivatives.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace gonio::calibration {
namespace {

constexpr std::array<double, LineNodes::kAtMost> kPlaces{0.0, -0.1, 0.15, -0.3, 0.35};

// y = 2 + 3 x + x^2 / 2 - x^3 + 2 x^4, through the first nodes of each lane; lanes beyond them have no line.
LineNodes quartic(const std::array<std::size_t, kLineLanes>& sizes) {
  LineNodes nodes;
  for (std::size_t lane = 0; lane < kLineLanes; ++lane) {
    nodes.size[lane] = static_cast<double>(sizes[lane]);
    for (std::size_t n = 0; n < kPlaces.size(); ++n) {
      const double x = kPlaces[n];
      nodes.x[n][lane] = x;
      if (n < sizes[lane]) nodes.y[n][lane] = 2.0 + 3.0 * x + 0.5 * x * x - x * x * x + 2.0 * x * x * x * x;
    }
  }
  return nodes;
}

TEST(LineDerivatives, AreExactForAQuarticThroughFiveNodes) {
  LineDerivatives found;

  differentiate(quartic({5, 5, 5, 5}), found);

  for (std::size_t lane = 0; lane < kLineLanes; ++lane) {
    // Of the cubic through the first four: y[x_0 .. x_3] of x^4 is the sum of the nodes, -0.25.
    EXPECT_NEAR(found.third2[lane], 81.0, 1e-9);     // (6 (-1 - 2 * 0.25))^2
    EXPECT_NEAR(found.fourth2[lane], 2304.0, 1e-6);  // (24 * 2)^2
    EXPECT_NEAR(found.first[lane], 3.0, found.first_missed[lane]);
    EXPECT_NEAR(found.second[lane], 1.0, found.second_missed[lane]);
  }
}

// Two nodes: the chord, held against a constant. Three: both derivatives; half of the second is missed.
TEST(LineDerivatives, OfEachLineComeFromItsOwnNodesAlone) {
  LineDerivatives found;

  differentiate(quartic({1, 2, 3, 0}), found);

  const double y1 = 2.0 - 0.3 + 0.005 + 0.001 + 0.0002;
  const double chord = (y1 - 2.0) / -0.1;
  EXPECT_EQ(found.first[0], 0.0);
  EXPECT_EQ(found.first_missed[0], 0.0);
  EXPECT_NEAR(found.first[1], chord, 1e-12);
  EXPECT_NEAR(found.first_missed[1], chord, 1e-12);
  EXPECT_EQ(found.second[1], 0.0);
  const double y2 = 2.0 + 0.45 + 0.01125 - 0.003375 + 2.0 * std::pow(0.15, 4);
  const double second = 2.0 * (chord - (y2 - 2.0) / 0.15) / (-0.1 - 0.15);
  EXPECT_NEAR(found.second[2], second, 1e-10);
  EXPECT_NEAR(found.second_missed[2], 0.5 * second, 1e-10);
  EXPECT_EQ(found.first[3], 0.0);
  EXPECT_EQ(found.third2[2], 0.0);
}

// f = exp(y): f'' / f = y'' + y'^2.
TEST(LineDerivatives, OfALogarithmAreThoseOfItsFunctionOverIt) {
  LineNodes nodes = quartic({3, 3, 3, 3});
  nodes.is_logarithm[1] = 1.0;
  LineDerivatives found;

  differentiate(nodes, found);

  EXPECT_EQ(found.first[1], found.first[0]);
  // Of the order for the second derivative, the parabola, the slope is not told; f'' / f - y'' is its square.
  const double slope2 = found.second[1] - found.second[0];
  EXPECT_NEAR(std::sqrt(slope2), 3.0, 0.1);
}

// A line of noise alone: the straight line through the nearest node has least of it.
TEST(LineDerivatives, ChooseTheOrderWithLeastNoiseAndLeastMissed) {
  LineNodes nodes;
  for (std::size_t n = 0; n < kPlaces.size(); ++n) {
    nodes.x[n][0] = kPlaces[n];
    nodes.x[n][1] = nodes.x[n][2] = nodes.x[n][3] = static_cast<double>(n);
    nodes.y[n][0] = 1.0;
    nodes.u2[n][0] = 1.0;
  }
  nodes.size[0] = 5.0;
  LineDerivatives found;

  differentiate(nodes, found);

  EXPECT_NEAR(found.first[0], 0.0, 1e-9);
  EXPECT_GT(found.second_noise2[0], 0.0);
  EXPECT_EQ(found.fourth2[0], 0.0) << "below its noise";
}

}  // namespace
}  // namespace gonio::calibration
