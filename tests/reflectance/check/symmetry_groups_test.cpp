#include "reflectance/check/symmetry_groups.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

using Group = std::vector<std::size_t>;

SymmetryPoint at(Geometry g) {
  return {.geometry = g, .value = per_steradian(0.1), .u_random = per_steradian(0.001), .shared = {}};
}

// In degrees.
Geometry all_four(double theta_i, double phi_i, double theta_r, double phi_r) {
  return {.theta_i = degrees(theta_i), .phi_i = degrees(phi_i), .theta_r = degrees(theta_r), .phi_r = degrees(phi_r)};
}

SymmetryGroups groups(Symmetry symmetry, const std::vector<SymmetryPoint>& points, Sameness sameness) {
  return find_symmetry_groups(symmetry, points, {.sameness = sameness}).value();
}

TEST(SymmetryGroups, PairExchangedDirectionsToTheLetter) {
  const std::vector<SymmetryPoint> points{at(all_four(30, 10, 60, 80)), at(all_four(30, 0, 60, 70)),
                                          at(all_four(60, 80.01, 30, 369.99))};

  const SymmetryGroups exact = groups(Symmetry::Reciprocity, points, Sameness::Exact);

  EXPECT_THAT(exact.groups, ElementsAre(Group{0, 2}));
  EXPECT_EQ(exact.unpaired, 1u);
  EXPECT_EQ(exact.trivial, 0u);
}

TEST(SymmetryGroups, PairExchangedDirectionsAfterATurnOnlyWhenTheSampleMayBeTurned) {
  // phi_i = 0 throughout: the exchange of (30; 60, 70) is (60, 70; 30, 0), turned (60; 30, -70).
  const std::vector<SymmetryPoint> turned{at(geometry(30, 60, 70)), at(geometry(60, 30, -70))};
  const std::vector<SymmetryPoint> mirrored_too{at(geometry(30, 60, 70)), at(geometry(60, 30, 70))};

  EXPECT_THAT(groups(Symmetry::Reciprocity, turned, Sameness::Exact).groups, IsEmpty());
  EXPECT_THAT(groups(Symmetry::Reciprocity, turned, Sameness::Turned).groups, ElementsAre(Group{0, 1}));
  EXPECT_THAT(groups(Symmetry::Reciprocity, mirrored_too, Sameness::Turned).groups, IsEmpty());
  EXPECT_EQ(groups(Symmetry::Reciprocity, mirrored_too, Sameness::Turned).unpaired, 2u);
  EXPECT_THAT(groups(Symmetry::Reciprocity, mirrored_too, Sameness::TurnedOrMirrored).groups, ElementsAre(Group{0, 1}));
}

TEST(SymmetryGroups, CountRetroReflectionAsTrivialAndNeverPairItEvenIfReadTwice) {
  const std::vector<SymmetryPoint> points{at(geometry(30, 30, 0)), at(geometry(30, 30, 0)), at(geometry(0, 0, 0)),
                                          at(geometry(30, 30.02, 0.01)), at(geometry(30, 30, 180))};

  const SymmetryGroups exact = groups(Symmetry::Reciprocity, points, Sameness::Exact);
  const SymmetryGroups turned = groups(Symmetry::Reciprocity, points, Sameness::Turned);

  EXPECT_THAT(exact.groups, IsEmpty());
  EXPECT_EQ(exact.trivial, 4u);  // 30.02 deg is within the tolerance of retro-reflection
  EXPECT_EQ(exact.unpaired, 1u);
  EXPECT_EQ(turned.trivial, 5u);  // the specular geometry exchanged is itself, turned
}

TEST(SymmetryGroups, UseEachPointOnceAndTheNearestFirst) {
  const std::vector<SymmetryPoint> points{at(geometry(20, 50, 0)), at(geometry(50.03, 20, 0)), at(geometry(50, 20, 0)),
                                          at(geometry(50, 20, 0))};

  const SymmetryGroups found = groups(Symmetry::Reciprocity, points, Sameness::Exact);

  EXPECT_THAT(found.groups, ElementsAre(Group{0, 2}));
  EXPECT_EQ(found.unpaired, 2u);
}

TEST(SymmetryGroups, PairLeftWithRightAcrossTheWrapAndAcrossTheNormal) {
  // 350 is -10; an arm at theta_r -40 and phi 170 points to (40, 350).
  const std::vector<SymmetryPoint> points{at(all_four(30, 0, 40, 10)),   at(all_four(30, 0, 40, 350)),
                                          at(all_four(30, 90, 50, 100)), at(all_four(30, 90, -50, 260)),
                                          at(all_four(30, 0, 60, 180)),  at(all_four(30, 90, 20, 91))};

  const SymmetryGroups found = groups(Symmetry::LeftRight, points, Sameness::Exact);

  EXPECT_THAT(found.groups, ElementsAre(Group{0, 1}, Group{2, 3}));
  EXPECT_EQ(found.trivial, 1u);
  EXPECT_EQ(found.unpaired, 1u);
}

TEST(SymmetryGroups, GatherTheTurnsOfOneGeometryAndCountRepeats) {
  const std::vector<SymmetryPoint> points{at(all_four(30, 0, 40, 10)),     at(all_four(30, 90, 40, 100)),
                                          at(all_four(30, 180, 40, -170)), at(all_four(30, 90, 40, 100)),
                                          at(all_four(30, 0, 40, -10)),    at(all_four(0, 0, 0, 0))};

  const SymmetryGroups found = groups(Symmetry::Turn, points, Sameness::Exact);

  EXPECT_THAT(found.groups, ElementsAre(Group{0, 1, 2}));
  EXPECT_EQ(found.repeated, 1u);
  EXPECT_EQ(found.unpaired, 1u);  // the mirror image is no turn
  EXPECT_EQ(found.trivial, 1u);
}

TEST(SymmetryGroups, TakeEveryAzimuthForATurnAtNormalIncidenceAndAtNormalView) {
  const std::vector<SymmetryPoint> points{at(geometry(0, 40, 10)), at(geometry(0, 40, 200)), at(all_four(40, 10, 0, 0)),
                                          at(all_four(40, 200, 0, 0))};

  EXPECT_THAT(groups(Symmetry::Turn, points, Sameness::Exact).groups, ElementsAre(Group{0, 1}, Group{2, 3}));
}

TEST(SymmetryGroups, ExchangeNormalIncidenceWithNormalView) {
  const std::vector<SymmetryPoint> points{at(geometry(0, 40, 10)), at(all_four(40, 10, 0, 77))};

  EXPECT_THAT(groups(Symmetry::Reciprocity, points, Sameness::Exact).groups, ElementsAre(Group{0, 1}));
}

TEST(SymmetryGroups, RefuseWhatIsNoGeometryAndSayWhichPoint) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Geometry& bad : {all_four(91, 0, 0, 0), all_four(0, nan, 0, 0), all_four(0, 0, -91, 0),
                              all_four(0, 0, 0, HUGE_VAL), all_four(nan, 0, 0, 0)}) {
    const std::vector<SymmetryPoint> points{at(geometry(0, 0, 0)), at(bad)};
    const Result<SymmetryGroups> refused = find_symmetry_groups(Symmetry::LeftRight, points, {});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::InvalidInput);
    EXPECT_NE(refused.error().tried.find("point 1"), std::string::npos);
  }
  for (const Angle tolerance : {radians(nan), -1.0_deg, 5.1_deg}) {
    EXPECT_FALSE(find_symmetry_groups(Symmetry::Turn, {}, {.tolerance = tolerance}));
  }
}

}  // namespace
}  // namespace gonio::reflectance
