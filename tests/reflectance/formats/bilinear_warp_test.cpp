#include "reflectance/formats/bilinear_warp.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace gonio::formats {
namespace {

TEST(BilinearWarp, OfAnEvenTableMovesNothing) {
  const BilinearWarp warp(3, 4, std::vector<double>(12, 2.5));
  for (const double u : {0.0, 0.3, 0.5, 1.0}) {
    for (const double v : {0.0, 0.25, 0.9, 1.0}) {
      EXPECT_NEAR(warp.warped({u, v}).u, u, 1e-14);
      EXPECT_NEAR(warp.warped({u, v}).v, v, 1e-14);
      EXPECT_NEAR(warp.at({u, v}), 2.5, 1e-14);
    }
  }
}

// Density u (1 + 2 v): u = sqrt(s), and v + v^2 = 2 s.
TEST(BilinearWarp, FollowsAClosedForm) {
  const BilinearWarp warp(2, 2, std::array{0.0, 1.0, 0.0, 3.0});
  for (const double s : {0.0, 0.1, 0.5, 0.77, 1.0}) {
    EXPECT_NEAR(warp.warped({s, 0.3}).u, std::sqrt(s), 1e-14);
    EXPECT_NEAR(warp.warped({0.3, s}).v, 0.5 * (std::sqrt(1.0 + 8.0 * s) - 1.0), 1e-14);
  }
}

// The mass to the left of and below where a point goes to is the point, whatever the table.
TEST(BilinearWarp, KeepsMass) {
  const std::array<double, 12> table{1, 0, 2, 5, 0, 0, 3, 1, 4, 1, 0, 2};
  const BilinearWarp warp(3, 4, table);
  constexpr int kSteps = 400;
  const auto mass = [&](double u, double v) {
    double sum = 0.0;
    for (int a = 0; a < kSteps; ++a)
      for (int b = 0; b < kSteps; ++b) sum += warp.at({u * (a + 0.5) / kSteps, v * (b + 0.5) / kSteps});
    return sum * u * v / (kSteps * kSteps);
  };
  const double whole = mass(1.0, 1.0);
  for (const double s : {0.2, 0.45, 0.8}) {
    EXPECT_NEAR(mass(1.0, warp.warped({0.5, s}).v) / whole, s, 1e-4);
    const SquarePoint p = warp.warped({s, 0.6});
    double left = 0.0;
    double row = 0.0;
    for (int a = 0; a < kSteps; ++a) {
      left += warp.at({p.u * (a + 0.5) / kSteps, p.v}) * p.u;
      row += warp.at({(a + 0.5) / kSteps, p.v});
    }
    EXPECT_NEAR(left / row, s, 1e-4);
  }
}

}  // namespace
}  // namespace gonio::formats
