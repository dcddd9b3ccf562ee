#include "daemon/planner/planner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "daemon/planner/anchor.h"
#include "daemon/planner/measuring_order.h"
#include "tests/daemon/support/bench_instrument.h"

namespace gonio::daemon {
namespace {

using stage::Axis;
using test::bench_instrument;
using test::bench_plan;

TEST(Planner, TheProductOfTheListsHasThetaISlowestAndPhiRFastest) {
  const auto planned = expand(bench_plan({10, 20}, {30, 40}, {90, 180}), bench_instrument());

  ASSERT_TRUE(planned) << describe(planned.error());
  ASSERT_EQ(planned->points.size(), 8U);
  EXPECT_NEAR(in_degrees(planned->points[1].geometry.phi_r), 180.0, 1e-12);
  EXPECT_NEAR(in_degrees(planned->points[2].geometry.theta_r), 40.0, 1e-12);
  EXPECT_NEAR(in_degrees(planned->points[4].geometry.theta_i), 20.0, 1e-12);
  EXPECT_EQ(planned->asked, 8);
  EXPECT_EQ(planned->merged, 0);
  EXPECT_EQ(planned->items, 16);
}

TEST(Planner, MergesAzimuthsAtTheDetectorsPoleAndCountsThem) {
  const auto planned = expand(bench_plan({30}, {0, 45}, {0, 90, 180}), bench_instrument());

  ASSERT_TRUE(planned);
  EXPECT_EQ(planned->asked, 6);
  EXPECT_EQ(planned->merged, 2);
  EXPECT_EQ(planned->points.size(), 4U);
}

TEST(Planner, MergesAzimuthsAtNormalIncidenceOnlyForAnIsotropicSample) {
  api::Plan plan = bench_plan({0}, {45}, {0, 90, 180});

  const auto isotropic = expand(plan, bench_instrument());
  plan.isotropic = false;
  const auto anisotropic = expand(plan, bench_instrument());

  ASSERT_TRUE(isotropic && anisotropic);
  EXPECT_EQ(isotropic->points.size(), 1U);
  EXPECT_EQ(isotropic->merged, 2);
  EXPECT_EQ(anisotropic->points.size(), 3U);
  EXPECT_EQ(anisotropic->merged, 0);
}

TEST(Planner, MergesAnAzimuthWithTheSameOneATurnLater) {
  const auto planned = expand(bench_plan({30}, {45}, {0, 180, 360}), bench_instrument());

  ASSERT_TRUE(planned);
  EXPECT_EQ(planned->points.size(), 2U);
  EXPECT_EQ(planned->merged, 1);
}

TEST(Planner, MarksPointsInTheShadowAndOrdersThemLast) {
  // Keep-out by hand: asin((20 + 20) / 500) = 4.588 deg; at 30/30 the phase angle for phi = 0 is 0, for 26 deg 4 deg.
  const auto planned = expand(bench_plan({30}, {26, 30, 35}, {0, 90}), bench_instrument());

  ASSERT_TRUE(planned);
  EXPECT_EQ(planned->blocked, 2);
  EXPECT_EQ(planned->items, 8);
  EXPECT_EQ(planned->order.size(), 4U);
  for (const ScanPoint& p : planned->points) {
    const bool near_retro = in_degrees(p.geometry.phi_r) == 0.0 && in_degrees(p.geometry.theta_r) < 34.0;
    EXPECT_EQ(p.blocked, near_retro) << p.index;
    EXPECT_EQ(p.rank >= 4, near_retro) << p.index;
  }
}

// An arm that reaches below the surface, a carriage place where nothing stands in the beam, an attenuator in slot 2.
Instrument instrument_for_a_direct_beam() {
  Instrument instrument = bench_instrument();
  instrument.stage.axes[stage::index_of(Axis::ThetaR)].high = 105.0;
  instrument.carriage.open = millimetres(180.0);
  instrument.filters.push_back({.slot = 2,
                                .centroid = nanometres(568.0),
                                .fwhm = nanometres(10.0),
                                .attenuation = Measured<double>{1e-3, 2e-6}});
  return instrument;
}

TEST(Planner, LooksIntoTheSourceOnlyThroughTheAttenuatorAtTheOpenPlace) {
  const Instrument instrument = instrument_for_a_direct_beam();
  const Geometry straight{.theta_i = degrees(80.0), .phi_i = {}, .theta_r = degrees(100.0), .phi_r = degrees(180.0)};
  const Geometry above{.theta_i = degrees(80.0), .phi_i = {}, .theta_r = degrees(10.0), .phi_r = degrees(180.0)};

  const auto into = axis_targets(straight, nanometres(568.0), instrument, home_position(instrument));
  const auto onto = axis_targets(above, nanometres(568.0), instrument, home_position(instrument));

  ASSERT_TRUE(into && onto);
  EXPECT_EQ((*into)[stage::index_of(Axis::FilterWheel)], 2.0);
  EXPECT_EQ((*onto)[stage::index_of(Axis::FilterWheel)], 1.0) << "never for a target";
  EXPECT_EQ(in_millimetres(carriage_place(instrument, calibration::Target::Sample, straight)), 180.0);
  EXPECT_EQ(in_millimetres(carriage_place(instrument, calibration::Target::Sample, above)), 0.0);
  EXPECT_EQ(in_millimetres(carriage_place(instrument, calibration::Target::Reference, above)), 120.0);
}

TEST(Planner, RefusesALookIntoTheSourceWithoutAttenuatorOrOpenPlace) {
  const api::Plan straight = bench_plan({80}, {100}, {180});
  Instrument without_attenuator = instrument_for_a_direct_beam();
  without_attenuator.filters.pop_back();
  Instrument without_open_place = instrument_for_a_direct_beam();
  without_open_place.carriage.open.reset();

  const auto bare = expand(straight, without_attenuator);
  const auto covered = expand(straight, without_open_place);

  ASSERT_FALSE(bare || covered);
  EXPECT_EQ(bare.error().code, ErrorCode::InvalidInput);
  EXPECT_NE(describe(bare.error()).find("attenuator"), std::string::npos) << describe(bare.error());
  EXPECT_NE(describe(covered.error()).find("open_mm"), std::string::npos) << describe(covered.error());
  EXPECT_TRUE(expand(straight, instrument_for_a_direct_beam()));
}

TEST(Planner, RefusesAPlanWithEveryPointBlocked) {
  const auto planned = expand(bench_plan({30}, {30}, {0}), bench_instrument());

  ASSERT_FALSE(planned);
  EXPECT_EQ(planned.error().code, ErrorCode::AllPointsBlocked);
}

TEST(Planner, RefusesAnAngleBeyondItsAxisAndNamesAxisValueLimitAndField) {
  const auto planned = expand(bench_plan({30}, {0, 97.2}, {90}), bench_instrument());

  ASSERT_FALSE(planned);
  EXPECT_EQ(planned.error().code, ErrorCode::OutOfLimits);
  EXPECT_EQ(planned.error().tried, "move theta_r to 97.200 deg");
  EXPECT_EQ(planned.error().seen, "target 97.200 deg");
  EXPECT_EQ(planned.error().limit, "0.000 to 85.000 deg");
  ASSERT_TRUE(planned.error().where);
  EXPECT_EQ(planned.error().where->field, "geometry.theta_r_deg");
}

TEST(Planner, RefusesAWavelengthWithoutAFilterAndNamesThoseThereAre) {
  api::Plan plan = bench_plan({30}, {0}, {90});
  plan.wavelengths = {nanometres(700.0)};

  const auto planned = expand(plan, bench_instrument());

  ASSERT_FALSE(planned);
  EXPECT_EQ(planned.error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(planned.error().seen, "700 nm");
  EXPECT_EQ(planned.error().where->field, "geometry.wavelength_nm");
  EXPECT_NE(planned.error().limit.find("568"), std::string::npos);
}

Instrument two_colours() {
  Instrument instrument = bench_instrument();
  instrument.filters.push_back({.slot = 2, .centroid = nanometres(650.0), .fwhm = nanometres(10.0)});
  return instrument;
}

TEST(Planner, AddsTheAnchorForEachWavelengthThatLacksIt) {
  api::Plan plan = bench_plan({0, 30}, {20, 60}, {90});
  plan.wavelengths = {nanometres(568.0), nanometres(650.0)};
  plan.reference_mode = api::ReferenceMode::Anchor;
  plan.reference_every = std::chrono::minutes(2);
  const auto same_geometry = expand(bench_plan({0, 30}, {20, 60}, {90}), two_colours());

  const auto planned = expand(plan, two_colours());

  ASSERT_TRUE(planned && same_geometry) << describe(planned.error());
  EXPECT_EQ(planned->points.size(), 10U);
  EXPECT_EQ(planned->anchors, 2);
  EXPECT_EQ(planned->items, 10) << "no partners on the reference";
  EXPECT_EQ(same_geometry->items, 8);
  EXPECT_EQ(anchor_points(planned->points, plan.anchor).size(), 2U);
}

TEST(Planner, TakesThePlansOwnPointAsItsAnchor) {
  api::Plan plan = bench_plan({0, 30}, {20, 45}, {90, 270});
  plan.reference_mode = api::ReferenceMode::Anchor;
  plan.reference_every = std::chrono::minutes(2);

  const auto planned = expand(plan, bench_instrument());

  ASSERT_TRUE(planned) << describe(planned.error());
  EXPECT_EQ(planned->anchors, 0) << "at normal incidence the standard is the same at every azimuth";
  ASSERT_EQ(anchor_points(planned->points, plan.anchor).size(), 1U);
}

TEST(Planner, RefusesAnAnchorThatCannotBeVisited) {
  api::Plan plan = bench_plan({0, 30}, {20, 60}, {90});
  plan.reference_mode = api::ReferenceMode::Anchor;
  plan.anchor = {.theta_i = degrees(30), .phi_i = {}, .theta_r = degrees(31), .phi_r = {}};

  const auto in_the_shadow = expand(plan, bench_instrument());
  plan.anchor = {.theta_i = {}, .phi_i = {}, .theta_r = degrees(88), .phi_r = {}};
  const auto out_of_reach = expand(plan, bench_instrument());

  ASSERT_FALSE(in_the_shadow || out_of_reach);
  EXPECT_EQ(in_the_shadow.error().code, ErrorCode::Blocked);
  EXPECT_EQ(in_the_shadow.error().where->field, "reference.anchor");
  EXPECT_EQ(out_of_reach.error().code, ErrorCode::OutOfLimits);
  EXPECT_EQ(out_of_reach.error().where->field, "reference.anchor.theta_r_deg");
}

TEST(Planner, AnAnchoredScanTakesAboutHalfTheTime) {
  std::vector<double> many;
  for (int k = 0; k < 60; ++k) many.push_back(5.0 + k);
  api::Plan plan = bench_plan({0, 30, 60}, many, {90, 135});
  plan.block = std::chrono::minutes(15);
  plan.reference_every = plan.block;
  const auto pairs = expand(plan, bench_instrument());
  plan.reference_mode = api::ReferenceMode::Anchor;

  const auto anchored = expand(plan, bench_instrument());
  plan.reference_mode = api::ReferenceMode::Absolute;
  plan.reference_every = {};
  const auto absolute = expand(plan, bench_instrument());

  ASSERT_TRUE(pairs && anchored && absolute);
  const double ratio = in_seconds(anchored->estimate.total()) / in_seconds(pairs->estimate.total());
  EXPECT_GT(ratio, 0.45);
  EXPECT_LT(ratio, 0.65);
  EXPECT_LT(absolute->estimate.total(), anchored->estimate.total());
}

TEST(Planner, RefusesMorePointsThanAnyScanCanHave) {
  const std::vector<double> many(4000, 10.0);

  const auto planned = expand(bench_plan({30}, many, many), bench_instrument());

  ASSERT_FALSE(planned);
  EXPECT_EQ(planned.error().code, ErrorCode::InvalidInput);
}

TEST(Planner, TurnsAnAzimuthIntoItsAxis) {
  const Geometry g{.theta_i = degrees(30), .theta_r = degrees(10), .phi_r = degrees(345)};

  const auto target = axis_targets(g, nanometres(568), bench_instrument(), {});

  ASSERT_TRUE(target);
  EXPECT_NEAR(*(*target)[stage::index_of(Axis::PhiR)], -15.0, 1e-9);
  EXPECT_EQ(*(*target)[stage::index_of(Axis::FilterWheel)], 1.0);
}

// Heads of 50 and 45 mm whose radii overlap: the arms keep 10 mm from about 11 deg on.
Instrument instrument_with_keep_out() {
  Instrument instrument = bench_instrument();
  instrument.stage.keep_out.emplace(drivers::ArmHead{millimetres(550.0), millimetres(800.0), millimetres(50.0)},
                                    drivers::ArmHead{millimetres(500.0), millimetres(700.0), millimetres(45.0)},
                                    millimetres(10.0));
  return instrument;
}

TEST(Planner, BlocksAPointOutsideOfTheShadowWhereTheArmsWouldMeet) {
  const api::Plan plan = bench_plan({30}, {20, 36, 60}, {0});

  const auto open = expand(plan, bench_instrument());
  const auto kept_out = expand(plan, instrument_with_keep_out());

  ASSERT_TRUE(open && kept_out);
  EXPECT_EQ(open->blocked, 0);
  EXPECT_EQ(kept_out->blocked, 2);
}

TEST(Planner, TheEstimateHoldsTheWayRoundTheOtherArm) {
  api::Plan plan = bench_plan({40}, {20, 60}, {0});
  plan.order = api::OrderStrategy::AsWritten;

  const auto direct = expand(plan, bench_instrument());
  const auto round = expand(plan, instrument_with_keep_out());

  ASSERT_TRUE(direct && round) << describe(round.error());
  EXPECT_GT(round->estimate.move, direct->estimate.move + std::chrono::seconds(1));
}

TEST(Planner, RefusesAPlanWithAPointThatTheArmsCannotComeToAndNamesThePlace) {
  Instrument narrow = instrument_with_keep_out();
  for (const Axis azimuth : {Axis::PhiR, Axis::PhiI}) {
    narrow.stage.axes[stage::index_of(azimuth)].low = -1.0;
    narrow.stage.axes[stage::index_of(azimuth)].high = 1.0;
  }

  const auto planned = expand(bench_plan({40}, {20, 60}, {0}), narrow);

  ASSERT_FALSE(planned);
  EXPECT_EQ(planned.error().code, ErrorCode::Blocked);
  EXPECT_NE(planned.error().tried.find("come to point"), std::string::npos) << describe(planned.error());
  EXPECT_NE(planned.error().seen.find("deg of each other on the way"), std::string::npos);
}

TEST(Planner, TheEstimateHoldsTheTurnsOfAnApproachSide) {
  api::Plan plan = bench_plan({30}, {60, 20}, {90});
  plan.order = api::OrderStrategy::AsWritten;
  Instrument with_side = bench_instrument();
  drivers::AxisConfig& theta_r = with_side.stage.axes[stage::index_of(Axis::ThetaR)];
  theta_r.approach = drivers::Approach::FromBelow;
  theta_r.overrun = 0.8;

  const auto without = expand(plan, bench_instrument());
  const auto with = expand(plan, with_side);

  ASSERT_TRUE(without && with);
  // One move down, from 60 to 20 deg: 0.8 deg further at 20 deg/s, and back by it: 2 sqrt(0.8 / 40) s.
  EXPECT_NEAR(in_seconds(with->estimate.move - without->estimate.move), 0.8 / 20.0 + 2.0 * std::sqrt(0.8 / 40.0), 1e-6);
}

TEST(Planner, RefusesAPlanWithoutRoomToTurnAndNamesItsField) {
  Instrument with_side = bench_instrument();
  drivers::AxisConfig& theta_r = with_side.stage.axes[stage::index_of(Axis::ThetaR)];
  theta_r.approach = drivers::Approach::FromBelow;
  theta_r.overrun = 0.8;

  const auto planned = expand(bench_plan({30}, {0.5, 45}, {90}), with_side);

  ASSERT_FALSE(planned);
  EXPECT_EQ(planned.error().code, ErrorCode::OutOfLimits);
  EXPECT_EQ(planned.error().where->field, "geometry.theta_r_deg");
}

TEST(Planner, RefusesADirectionThatATurningSampleDoesNotReachAndNamesIt) {
  Instrument turning = bench_instrument();
  turning.stage.kinematics.kind = drivers::KinematicsKind::TurningSample;
  for (std::size_t a = 0; a < 4; ++a) turning.stage.axes[a].low = -180.0;
  for (std::size_t a = 0; a < 4; ++a) turning.stage.axes[a].high = 180.0;
  turning.stage.axes[stage::index_of(Axis::ThetaI)].high = 40.0;  // yaw
  turning.stage.axes[stage::index_of(Axis::ThetaI)].low = -40.0;
  turning.stage.axes[stage::index_of(Axis::PhiI)].high = 5.0;  // pitch
  turning.stage.axes[stage::index_of(Axis::PhiI)].low = -5.0;

  const auto reached = expand(bench_plan({30}, {20}, {180}), turning);
  const auto refused = expand(bench_plan({60}, {20}, {180}), turning);

  EXPECT_TRUE(reached) << describe(reached.error());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::OutOfLimits);
  EXPECT_EQ(refused.error().where->field, "geometry");
  EXPECT_NE(refused.error().tried.find("for theta_i 60.000"), std::string::npos) << refused.error().tried;
}

TEST(Planner, FastestIsNoSlowerThanAsWrittenAndVisitsTheSamePoints) {
  api::Plan plan = bench_plan({0, 30, 60}, {0, 20, 40, 60}, {30, 60, 90, 120, 150, 180});
  const auto fastest = expand(plan, bench_instrument());
  plan.order = api::OrderStrategy::AsWritten;
  const auto written = expand(plan, bench_instrument());

  ASSERT_TRUE(fastest && written);
  EXPECT_LT(fastest->estimate.move, written->estimate.move);
  EXPECT_EQ(std::set<std::int32_t>(fastest->order.begin(), fastest->order.end()),
            std::set<std::int32_t>(written->order.begin(), written->order.end()));
  EXPECT_TRUE(std::is_sorted(written->order.begin(), written->order.end()));
}

TEST(Planner, ABoustrophedonMovesOneAxisToANeighbourAtEachStep) {
  const auto planned = expand(bench_plan({10, 30}, {20, 40, 60}, {90, 120, 150}), bench_instrument());

  ASSERT_TRUE(planned);
  const auto order = snaked_order(bench_instrument(), planned->points);
  ASSERT_EQ(order.size(), 18U);
  for (std::size_t k = 1; k < order.size(); ++k) {
    const Geometry& a = planned->points[static_cast<std::size_t>(order[k - 1])].geometry;
    const Geometry& b = planned->points[static_cast<std::size_t>(order[k])].geometry;
    const int changed = (a.theta_i != b.theta_i) + (a.theta_r != b.theta_r) + (a.phi_r != b.phi_r);
    EXPECT_EQ(changed, 1) << "step " << k;
  }
}

TEST(Planner, RandomOrderFollowsItsSeedAlone) {
  api::Plan plan = bench_plan({30}, {10, 20, 40, 50, 60}, {60, 90, 120, 150});
  plan.order = api::OrderStrategy::Random;
  plan.order_seed = 11;
  const auto a = expand(plan, bench_instrument());
  const auto again = expand(plan, bench_instrument());
  plan.order_seed = 12;
  const auto b = expand(plan, bench_instrument());

  ASSERT_TRUE(a && again && b);
  EXPECT_EQ(a->order, again->order);
  EXPECT_NE(a->order, b->order);
}

TEST(Planner, TheEstimateCountsEachMoveOfTheWayAndBothTargets) {
  // By hand: one point at theta_i 30, theta_r 0, phi 0. The source arm takes 30/20 + 20/40 = 2 s, the filter wheel one
  // slot at 2 slot/s with 4 slot/s^2 1 s beside it; then the carriage 120 mm at 100 mm/s with 200 mm/s^2: 1.7 s. Two
  // settles of 20 ms.
  const auto planned = expand(bench_plan({30}, {0}, {0}), bench_instrument());

  ASSERT_TRUE(planned);
  EXPECT_NEAR(in_seconds(planned->estimate.move), 3.7, 1e-6);
  EXPECT_NEAR(in_seconds(planned->estimate.settle), 0.04, 1e-9);
}

TEST(Planner, AMoveByHandIntoTheShadowIsBlocked) {
  stage::PerAxis<double> standing{};
  standing[stage::index_of(Axis::ThetaI)] = 30.0;
  drivers::MotionTarget target{};
  target[stage::index_of(Axis::ThetaR)] = 28.0;

  const auto into = check_move(target, standing, bench_instrument());
  target[stage::index_of(Axis::PhiR)] = 90.0;
  const auto beside = check_move(target, standing, bench_instrument());

  ASSERT_FALSE(into);
  EXPECT_EQ(into.error().code, ErrorCode::Blocked);
  EXPECT_TRUE(beside);
}

TEST(Planner, AMoveByHandBeyondALimitIsRefused) {
  drivers::MotionTarget target{};
  target[stage::index_of(Axis::Carriage)] = 300.0;

  const auto refused = check_move(target, {}, bench_instrument());

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::OutOfLimits);
  EXPECT_EQ(refused.error().limit, "-1.000 to 250.000 mm");
}

}  // namespace
}  // namespace gonio::daemon
