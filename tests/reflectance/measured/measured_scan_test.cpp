#include "reflectance/measured/measured_scan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/reflectance/measured/simulated_scan.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance::test {
namespace {

using ::testing::HasSubstr;

MeasuredScan small_scan() {
  return simulated_scan(wheat(), geometries({}), {}, 1);
}

TEST(MeasuredScanCheck, TakesAScanWithNegativeValuesAndArmsBeyondTheNormal) {
  MeasuredScan scan = small_scan();
  scan.points[3].value = per_steradian(-1e-4);
  scan.points[4].geometry.theta_r = degrees(-30.0);

  EXPECT_TRUE(check(scan));
}

TEST(MeasuredScanCheck, HasAWordForEachKindOfScanThatIsNone) {
  MeasuredScan empty = small_scan();
  empty.points.clear();
  MeasuredScan flagged = small_scan();
  for (MeasuredPoint& p : flagged.points) p.is_flagged = true;
  MeasuredScan nan = small_scan();
  nan.points[5].value = per_steradian(std::numeric_limits<double>::quiet_NaN());
  MeasuredScan below = small_scan();
  below.points[6].geometry.theta_r = degrees(95.0);
  MeasuredScan negative = small_scan();
  negative.points[7].u_random = per_steradian(-1.0);
  MeasuredScan stray = small_scan();
  stray.points[8].shared.push_back({99, per_steradian(1.0)});

  EXPECT_EQ(check(empty).error().seen, "no points");
  EXPECT_THAT(check(flagged).error().seen, HasSubstr("points are flagged"));
  EXPECT_THAT(check(nan).error().seen, HasSubstr("point 5: value nan"));
  EXPECT_THAT(check(below).error().seen, HasSubstr("point 6: theta_r 95 deg"));
  EXPECT_THAT(check(negative).error().seen, HasSubstr("point 7: u_random -1"));
  EXPECT_THAT(check(stray).error().seen, HasSubstr("point 8: component 99"));
}

TEST(MeasuredScanCheck, DoesNotLookAtFlaggedPoints) {
  MeasuredScan scan = small_scan();
  scan.points[5].value = per_steradian(std::numeric_limits<double>::quiet_NaN());
  scan.points[5].is_flagged = true;

  EXPECT_TRUE(check(scan));
  EXPECT_EQ(usable_points(scan).size(), scan.points.size() - 1);
  EXPECT_EQ(symmetry_points(scan).index[5], 6U);
}

TEST(MeasuredScanCheck, AddsRandomAndSharedPartsInQuadrature) {
  const MeasuredPoint point{.value = per_steradian(1.0),
                            .u_random = per_steradian(2.0),
                            .shared = {{0, per_steradian(-3.0)}, {1, per_steradian(6.0)}}};

  EXPECT_DOUBLE_EQ(standard_u(point).si(), 7.0);
}

}  // namespace
}  // namespace gonio::reflectance::test
