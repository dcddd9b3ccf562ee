#include "drivers/keep_out/keep_out.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gonio::drivers {
namespace {

const ArmHead kSource{millimetres(550.0), millimetres(800.0), millimetres(50.0)};
const ArmHead kDetector{millimetres(500.0), millimetres(700.0), millimetres(45.0)};

// The distance of the surfaces by trying points of both axes, a fifth of a millimetre apart.
double tried_clearance_mm(double angle_deg) {
  const double angle = in_radians(degrees(angle_deg));
  double least = std::numeric_limits<double>::infinity();
  for (double s = 550.0; s <= 800.0; s += 0.5) {
    for (double t = 500.0; t <= 700.0; t += 0.5) {
      least = std::min(least, std::hypot(s - t * std::cos(angle), t * std::sin(angle)));
    }
  }
  return least - 95.0;
}

TEST(KeepOut, ClearanceIsTheLeastDistanceOfAllPointsOfTheHeads) {
  const KeepOut keep_out(kSource, kDetector, millimetres(10.0));
  for (const double angle : {0.0, 1.0, 5.0, 11.0, 20.0, 45.0, 89.0, 91.0, 135.0, 180.0}) {
    EXPECT_NEAR(in_millimetres(keep_out.clearance(degrees(angle))), tried_clearance_mm(angle), 0.05) << angle;
  }
}

TEST(KeepOut, KeepsTheMarginFromTheLeastAngleOn) {
  const KeepOut keep_out(kSource, kDetector, millimetres(10.0));

  const Angle least = keep_out.least_separation();

  // The ends nearest to the sample of the outer head, 550 mm, and the inner head's axis: 550 sin(xi) = 105 mm.
  EXPECT_NEAR(in_degrees(least), in_degrees(radians(std::asin(105.0 / 550.0))), 1e-9);
  EXPECT_NEAR(in_millimetres(keep_out.clearance(least)), 10.0, 1e-9);
}

TEST(KeepOut, HeadsAtOtherRadiiPassEachOther) {
  const ArmHead outside{millimetres(820.0), millimetres(1000.0), millimetres(50.0)};

  const KeepOut keep_out(outside, kDetector, millimetres(10.0));

  EXPECT_EQ(keep_out.least_separation(), Angle{});
  EXPECT_NEAR(in_millimetres(keep_out.clearance(Angle{})), 820.0 - 700.0 - 95.0, 1e-9);
}

}  // namespace
}  // namespace gonio::drivers
