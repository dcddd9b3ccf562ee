#include "drivers/kinematics/kinematics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>
#include <vector>

#include "drivers/kinematics/turning_sample.h"
#include "tests/drivers/kinematics/forward_geometry.h"

namespace gonio::drivers {
namespace {

using stage::Axis;
using stage::index_of;
using testing::HasSubstr;

constexpr double kArc_rad = 1e-12;

StageConfig stage_with(KinematicsConfig kinematics, double reach_deg = 400.0) {
  StageConfig config;
  for (AxisConfig& axis : config.axes)
    axis = {.low = -reach_deg, .high = reach_deg, .speed = 20.0, .acceleration = 40.0};
  config.kinematics = kinematics;
  return config;
}

TurningSample in_plane() {
  return {};
}

TurningSample out_of_plane() {
  return {.yaw = Axis::PhiR,
          .pitch = Axis::ThetaI,
          .roll = Axis::ThetaR,
          .detector_arm = Axis::PhiI,
          .source_azimuth = degrees(25.0),
          .source_elevation = degrees(7.0),
          .detector_plane_tilt = degrees(-12.0)};
}

stage::PerAxis<double> positions_after(const MotionTarget& target) {
  stage::PerAxis<double> positions{};
  for (std::size_t a = 0; a < positions.size(); ++a) positions[a] = target[a].value_or(0.0);
  return positions;
}

SampleTurns turns_in(const TurningSample& sample, const stage::PerAxis<double>& positions) {
  return {.yaw = degrees(positions[index_of(sample.yaw)]),
          .pitch = degrees(positions[index_of(sample.pitch)]),
          .roll = degrees(positions[index_of(sample.roll)]),
          .detector = degrees(positions[index_of(sample.detector_arm)])};
}

// The hemisphere, denser where it is hard: the pole, retro, specular, grazing, and values a little beside each of them.
std::vector<Geometry> hemisphere() {
  const std::vector<double> thetas{0.0,  1e-14, 1e-9, 1e-6, 1e-3, 0.1,     1.0,       8.0,  15.0,       30.0,
                                   45.0, 60.0,  75.0, 85.0, 89.0, 89.9999, 89.999999, 90.0, 30.0 + 1e-7};
  const std::vector<double> dphis{0.0,   1e-10, 1e-5,      0.01,  5.0,   30.0, 90.0,
                                  137.0, 179.0, 179.99999, 180.0, -60.0, -1e-6};
  std::vector<Geometry> all;
  for (const double ti : thetas) {
    for (const double tr : thetas) {
      for (const double dphi : dphis) {
        for (const double phi_i : {0.0, 20.0, -170.0}) {
          all.push_back({degrees(ti), degrees(phi_i), degrees(tr), degrees(phi_i + dphi)});
        }
      }
    }
  }
  return all;
}

// The largest arc between what was asked for and what the turns make, by the test's own matrices, over all solutions.
double worst_arc(const TurningSample& sample, const Geometry& g, const std::vector<MotionTarget>& targets) {
  const test::Directions asked = test::directions_of_geometry(g);
  double worst = 0.0;
  for (const MotionTarget& target : targets) {
    const test::Directions made = test::forward(sample, turns_in(sample, positions_after(target)));
    worst = std::max({worst, test::arc(asked.source, made.source), test::arc(asked.detector, made.detector)});
  }
  return worst;
}

TEST(TurningSampleKinematics, EverySolutionOverTheHemisphereMakesTheDirectionsAskedFor) {
  const StageConfig config = stage_with({KinematicsKind::TurningSample, in_plane()});
  std::size_t ways = 0;
  for (const Geometry& g : hemisphere()) {
    const auto targets = solutions(g, config, {10.0, -20.0, 30.0, 5.0, 0.0, 0.0});
    ASSERT_TRUE(targets) << describe(targets.error());
    ways += targets->size();
    EXPECT_LT(worst_arc(in_plane(), g, *targets), kArc_rad)
        << in_degrees(g.theta_i) << " " << in_degrees(g.phi_i) << " " << in_degrees(g.theta_r) << " "
        << in_degrees(g.phi_r);
  }
  EXPECT_GT(ways, 3 * hemisphere().size());
}

TEST(TurningSampleKinematics, HoldsForASourceOutsideOfATiltedPlane) {
  const StageConfig config = stage_with({KinematicsKind::TurningSample, out_of_plane()});
  const double nearest = std::abs(source_out_of_plane(out_of_plane()).si());
  std::size_t reached = 0;
  for (const Geometry& g : hemisphere()) {
    const double xi = phase_angle(g).si();
    const auto targets = solutions(g, config, {});
    const bool is_in_reach = xi >= nearest && xi <= std::numbers::pi - nearest;
    ASSERT_EQ(targets.has_value(), is_in_reach) << in_degrees(radians(xi));
    if (!targets) continue;
    ++reached;
    EXPECT_LT(worst_arc(out_of_plane(), g, *targets), kArc_rad);
  }
  EXPECT_GT(reached, hemisphere().size() / 2);
}

TEST(TurningSampleKinematics, ForwardAgreesWithMatricesForAnyTurns) {
  constexpr unsigned kSeed = 20260707;
  SCOPED_TRACE(kSeed);
  std::mt19937_64 chance(kSeed);
  std::uniform_real_distribution<double> turn(-3.2, 3.2);
  for (int k = 0; k < 20000; ++k) {
    const SampleTurns turns{radians(turn(chance)), radians(turn(chance)), radians(turn(chance)), radians(turn(chance))};
    const test::Directions ours = test::directions_of_geometry(directions_of(out_of_plane(), turns));
    const test::Directions theirs = test::forward(out_of_plane(), turns);
    EXPECT_LT(test::arc(ours.source, theirs.source), 1e-14);
    EXPECT_LT(test::arc(ours.detector, theirs.detector), 1e-14);
    EXPECT_NEAR(separation_of(out_of_plane(), turns.detector).si(), test::arc(theirs.source, theirs.detector), 2e-15);
  }
}

TEST(TurningSampleKinematics, GivesTheReportedAnglesOfPlainCases) {
  // By hand. The sample yawed by +30 deg turns its normal from the source at x towards y: the source lies on the side
  // of -Y, phi = 180 deg, at 30 deg; a detector at 50 deg lies 20 deg on the other side, phi = 0.
  const Geometry yawed =
      directions_of(in_plane(), {.yaw = degrees(30.0), .pitch = {}, .roll = {}, .detector = degrees(50.0)});
  // Positive pitch lowers the normal: the source lies on the side of +Z, phi = 90 deg.
  const Geometry pitched = directions_of(in_plane(), {.yaw = {}, .pitch = degrees(40.0), .roll = {}, .detector = {}});
  // A roll turns the sample's own azimuths against the roll.
  const Geometry rolled =
      directions_of(in_plane(), {.yaw = {}, .pitch = degrees(40.0), .roll = degrees(25.0), .detector = {}});

  EXPECT_NEAR(in_degrees(yawed.theta_i), 30.0, 1e-12);
  EXPECT_NEAR(std::abs(in_degrees(yawed.phi_i)), 180.0, 1e-12);
  EXPECT_NEAR(in_degrees(yawed.theta_r), 20.0, 1e-12);
  EXPECT_NEAR(in_degrees(yawed.phi_r), 0.0, 1e-12);
  EXPECT_NEAR(in_degrees(pitched.phi_i), 90.0, 1e-12);
  EXPECT_NEAR(in_degrees(rolled.theta_i), 40.0, 1e-12);
  EXPECT_NEAR(in_degrees(rolled.phi_i), 65.0, 1e-12);
}

TEST(TurningSampleKinematics, KeepsTheDigitsNearThePoleThatACosineLoses) {
  // theta_i = 1e-8 rad: cos theta_i = 1 - 5e-17 rounds to 1, so that acos gives 0 for it.
  const SampleTurns turns{.yaw = radians(1e-8), .pitch = {}, .roll = {}, .detector = degrees(20.0)};

  const double naive = std::acos(std::cos(turns.yaw.si()) * std::cos(turns.pitch.si()));
  const Geometry ours = directions_of(in_plane(), turns);

  EXPECT_GT(std::abs(naive - 1e-8), 1e-9);
  EXPECT_NEAR(ours.theta_i.si(), 1e-8, 1e-23);
}

TEST(TurningSampleKinematics, LeavesTheRollWhereItStandsWhenAllIsAlongTheNormal) {
  const StageConfig config = stage_with({KinematicsKind::TurningSample, in_plane()});
  const Geometry normal{};  // theta_i = theta_r = 0
  stage::PerAxis<double> standing{};
  standing[index_of(Axis::PhiR)] = 77.0;  // roll

  const auto targets = solutions(normal, config, standing);

  ASSERT_TRUE(targets);
  EXPECT_NEAR(*targets->front()[index_of(Axis::PhiR)], 77.0, 1e-12);
  EXPECT_NEAR(*targets->front()[index_of(Axis::ThetaI)], 0.0, 1e-12);
}

TEST(TurningSampleKinematics, TurnsAboutTheBeamAsLittleAsItCanAtRetro) {
  const StageConfig config = stage_with({KinematicsKind::TurningSample, in_plane()});
  // Stands at retro already, turned about the beam in a way that no rule would choose.
  const stage::PerAxis<double> standing{33.0, 0.0, 12.0, -21.0, 0.0, 0.0};
  const Geometry here = directions(config.kinematics, standing);

  const auto targets = solutions(here, config, standing);

  ASSERT_TRUE(targets);
  for (const Axis axis : {Axis::ThetaI, Axis::ThetaR, Axis::PhiR, Axis::PhiI}) {
    EXPECT_NEAR(*targets->front()[index_of(axis)], standing[index_of(axis)], 1e-9) << stage::axis_name(axis);
  }
}

TEST(TurningSampleKinematics, KeepsTheYawWithTheNormalAlongItsAxis) {
  // The source and the detector lie in the horizontal plane: at theta_i = theta_r = 90 deg the normal may be vertical.
  const StageConfig config = stage_with({KinematicsKind::TurningSample, in_plane()});
  const Geometry grazing{degrees(90.0), {}, degrees(90.0), degrees(70.0)};

  const auto targets = solutions(grazing, config, {12.0, 0.0, 0.0, 80.0, 0.0, 0.0});

  ASSERT_TRUE(targets);
  EXPECT_NEAR(*targets->front()[index_of(Axis::ThetaI)], 12.0, 1e-9);
  EXPECT_LT(worst_arc(in_plane(), grazing, *targets), kArc_rad);
}

TEST(TurningSampleKinematics, FindsTheTurnsItStandsAtFromTheirOwnDirections) {
  constexpr unsigned kSeed = 31;
  SCOPED_TRACE(kSeed);
  const StageConfig config = stage_with({KinematicsKind::TurningSample, in_plane()});
  std::mt19937_64 chance(kSeed);
  std::uniform_real_distribution<double> position(-179.0, 179.0);
  for (int k = 0; k < 2000; ++k) {
    stage::PerAxis<double> standing{};
    for (std::size_t a = 0; a < 4; ++a) standing[a] = position(chance);
    const auto targets = solutions(directions(config.kinematics, standing), config, standing);
    ASSERT_TRUE(targets);
    for (std::size_t a = 0; a < 4; ++a) EXPECT_NEAR(*targets->front()[a], standing[a], 1e-6) << k << " axis " << a;
  }
}

TEST(TurningSampleKinematics, RefusesWhatNoTurnWithinTheLimitsMakesWithAxisValueAndLimit) {
  StageConfig config = stage_with({KinematicsKind::TurningSample, in_plane()}, 180.0);
  config.axes[index_of(Axis::ThetaI)].low = -60.0;  // yaw
  config.axes[index_of(Axis::ThetaI)].high = 60.0;
  config.axes[index_of(Axis::PhiI)].low = -10.0;  // pitch: only the horizontal plane
  config.axes[index_of(Axis::PhiI)].high = 10.0;
  const Geometry flat{degrees(75.0), {}, degrees(5.0), {}};

  const auto targets = solutions(flat, config, {});

  ASSERT_FALSE(targets);
  EXPECT_EQ(targets.error().code, ErrorCode::OutOfLimits);
  EXPECT_THAT(targets.error().tried, HasSubstr("move theta_i to"));
  EXPECT_THAT(targets.error().seen, HasSubstr("75.000 deg"));
  EXPECT_EQ(targets.error().limit, "-60.000 to 60.000 deg");
}

TEST(TurningSampleKinematics, RefusesAPhaseAngleSmallerThanTheSourceStandsOutOfThePlane) {
  TurningSample lifted = in_plane();
  lifted.source_elevation = degrees(10.0);
  const Geometry near_retro{degrees(30.0), {}, degrees(33.0), {}};

  const auto targets = solutions(near_retro, stage_with({KinematicsKind::TurningSample, lifted}), {});

  ASSERT_FALSE(targets);
  EXPECT_EQ(targets.error().code, ErrorCode::OutOfLimits);
  EXPECT_THAT(targets.error().tried, HasSubstr("phase angle of 3.000 deg"));
  EXPECT_EQ(targets.error().limit, "10.000 to 170.000 deg");
}

TEST(ArmKinematics, EveryAxisIsTheAngleOfItsName) {
  const StageConfig config = stage_with({}, 200.0);
  for (const Geometry& g : hemisphere()) {
    const auto targets = solutions(g, config, {});
    ASSERT_TRUE(targets);
    for (const MotionTarget& target : *targets) {
      const auto made = test::directions_of_geometry(directions(config.kinematics, positions_after(target)));
      const auto asked = test::directions_of_geometry(g);
      EXPECT_LT(test::arc(asked.source, made.source), kArc_rad);
      EXPECT_LT(test::arc(asked.detector, made.detector), kArc_rad);
    }
  }
}

TEST(ArmKinematics, TakesTheTurnThatIsNearestToWhereItStands) {
  StageConfig config = stage_with({}, 90.0);
  config.axes[index_of(Axis::PhiR)] = {.low = -185.0, .high = 365.0, .speed = 40.0, .acceleration = 80.0};
  const Geometry g{degrees(30.0), {}, degrees(20.0), degrees(345.0)};
  stage::PerAxis<double> far_round{};
  far_round[index_of(Axis::PhiR)] = 330.0;

  const auto from_zero = solutions(g, config, {});
  const auto from_330 = solutions(g, config, far_round);

  ASSERT_TRUE(from_zero && from_330);
  EXPECT_EQ(from_zero->size(), 2U);
  EXPECT_NEAR(*from_zero->front()[index_of(Axis::PhiR)], -15.0, 1e-9);
  EXPECT_NEAR(*from_330->front()[index_of(Axis::PhiR)], 345.0, 1e-9);
}

TEST(ArmKinematics, ReportsAzimuthsNearThePlannedOnes) {
  stage::PerAxis<double> positions{};
  positions[index_of(Axis::PhiR)] = -0.01;

  const Geometry g = directions_near({}, positions, {.phi_r = degrees(360.0)});

  EXPECT_NEAR(in_degrees(g.phi_r), 359.99, 1e-9);
}

}  // namespace
}  // namespace gonio::drivers
