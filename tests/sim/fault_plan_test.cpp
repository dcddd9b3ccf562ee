#include "sim/faults/fault_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/toml_reader.h"
#include "sim/faults/fault_desk.h"
#include "sim/scene/check_fault.h"
#include "sim/scene/read_faults.h"
#include "tests/sim/bench.h"

namespace gonio::sim::test {
namespace {

using testing::HasSubstr;

const auto kAnyFault = [](const PlannedFault&) { return true; };

Result<FaultPlan> read_text(const std::string& text) {
  auto root = TomlReader::parse(text, "x.toml");
  EXPECT_TRUE(root.has_value());
  FaultPlan plan = read_faults(*root);
  if (auto done = root->finish(); !done) return failure(done.error());
  return plan;
}

TEST(FaultPlan, IsReadFromAScene) {
  const auto plan = read_text(
      "[[faults]]\nname = \"missed-steps\"\ndevice = \"axis\"\naxis = \"theta_i\"\nby = 0.5\nafter = 7\n"
      "[[faults]]\nname = \"lamp-step\"\nat_s = 1800\nby_percent = -30\nfor_wall_s = 20\n");

  ASSERT_TRUE(plan.has_value()) << describe(plan.error());
  ASSERT_EQ(plan->size(), 2U);
  EXPECT_EQ(plan->at(0).kind, FaultKind::MissedSteps);
  EXPECT_EQ(plan->at(0).axis(), stage::Axis::ThetaI);
  EXPECT_EQ(plan->at(0).by(), 0.5);
  EXPECT_EQ(plan->at(0).after, 7U);
  EXPECT_EQ(plan->at(1).at_s, 1800.0);
  EXPECT_NEAR(plan->at(1).factor(), 0.7, 1e-15);
  EXPECT_EQ(plan->at(1).end(Instant{}), Instant{} + seconds(20.0));
}

TEST(FaultPlan, IsRefusedWithTheLineAndWhatWouldDo) {
  const auto said = [](const std::string& keys) {
    const auto plan = read_text("[[faults]]\n" + keys);
    return plan ? "taken" : describe(plan.error());
  };

  EXPECT_THAT(said("name = \"bad luck\"\n"), HasSubstr("reply-lost"));
  EXPECT_THAT(said("name = \"reply-lost\"\naxis = \"theta_i\"\n"), HasSubstr("exchange"));
  EXPECT_THAT(said("name = \"reply-lost\"\nexchange = \"chat\"\n"), HasSubstr("motion, shutters"));
  EXPECT_THAT(said("name = \"limit-hit\"\naxis = \"theta_q\"\n"), HasSubstr("phi_r"));
  EXPECT_THAT(said("name = \"reply-lost\"\ntimes = 0\n"), HasSubstr("1 to"));
  EXPECT_THAT(said("name = \"reply-lost\"\nafter = 1.5\n"), HasSubstr("whole number"));
  EXPECT_THAT(said("name = \"reply-lost\"\ndevice = \"camera\"\n"), HasSubstr("stage"));
}

TEST(FaultPlan, NamesTheRadiometerThatAFaultIsMeantFor) {
  const auto plan = read_text(
      "[[faults]]\nname = \"radiometer-stall\"\n"
      "[[faults]]\nname = \"radiometer-unplugged\"\nrole = \"monitor\"\nfor_wall_s = 2\n");
  const auto other = read_text("[[faults]]\nname = \"radiometer-stall\"\nrole = \"spare\"\n");

  ASSERT_TRUE(plan.has_value()) << describe(plan.error());
  EXPECT_EQ(plan->at(0).role(), FaultRole::Detector);
  EXPECT_EQ(plan->at(1).role(), FaultRole::Monitor);
  ASSERT_FALSE(other.has_value());
  EXPECT_THAT(describe(other.error()), HasSubstr("detector, monitor"));
}

TEST(FaultPlan, IsRefusedWhereTheSceneHasNoSuchDevice) {
  Scene scene = quiet_scene();
  scene.radiometers = {quiet_radiometer()};
  const auto said = [&](const FaultWish& wish) {
    const auto fits = check_fault(*planned_fault(wish), scene);
    return fits ? std::string("taken") : describe(fits.error());
  };

  EXPECT_EQ(said({.name = "radiometer-stall"}), "taken");
  EXPECT_THAT(said({.name = "radiometer-stall", .names = {{"role", "monitor"}}}),
              HasSubstr("no radiometer as monitor"));
  EXPECT_THAT(said({.name = "drive-power-cycle"}), HasSubstr("--stage drives"));
}

TEST(FaultDesk, StrikesAfterSoManyMomentsAndAsOftenAsAsked) {
  FaultDesk desk({PlannedFault{.kind = FaultKind::FrameLost, .after = 2, .times = 2}});
  std::vector<bool> struck;
  for (int k = 0; k < 6; ++k) struck.push_back(desk.strike(FaultMoment::Frame, 0.0, Instant{}, kAnyFault).has_value());

  EXPECT_EQ(struck, (std::vector<bool>{false, false, true, true, false, false}));
  EXPECT_EQ(desk.count(FaultKind::FrameLost, Instant{}).fired, 2U);
  EXPECT_EQ(desk.count(FaultKind::FrameLost, Instant{}).armed, 0U);
}

TEST(FaultDesk, LetsOneThatLastsStandForItsTime) {
  PlannedFault silence{.kind = FaultKind::StageSilent, .after = 0};
  silence.values[FaultParameter::ForWallS] = 2.0;
  FaultDesk desk({silence});
  (void)desk.strike(FaultMoment::Exchange, 0.0, Instant{}, kAnyFault);

  EXPECT_NE(desk.active(FaultKind::StageSilent, Instant{} + seconds(1.9)), nullptr);
  EXPECT_EQ(desk.active(FaultKind::StageSilent, Instant{} + seconds(2.0)), nullptr);
}

TEST(FaultsOfTheBench, ComeAtTheirSceneTimeHoweverLateTheyAreLookedAt) {
  Scene scene = quiet_scene();
  scene.faults.push_back({.kind = FaultKind::LampOff, .at_s = 5.0});
  Bench bench(std::move(scene));

  bench.wait(4.0);
  bench.instrument.advance_to(bench.now);
  const double before = bench.instrument.monitor_now(bench.now);
  bench.wait(4.0);
  bench.instrument.advance_to(bench.now);

  EXPECT_EQ(before, 1.0);
  EXPECT_EQ(bench.instrument.monitor_now(bench.now), 0.0);
  bench.instrument.end_fault(FaultKind::LampOff, bench.now);
  EXPECT_EQ(bench.instrument.monitor_now(bench.now), 1.0);
}

TEST(FaultsOfTheBench, LeaveTheEncoderWrongUntilHoming) {
  Bench bench;
  PlannedFault jump{.kind = FaultKind::EncoderJump};
  jump.values[FaultParameter::By] = 2.0;
  const auto shown = [&] {
    const AxisModel& axis = bench.instrument.stage().axis(Axis::ThetaR);
    return axis.counts(bench.now) * bench.instrument.scene().stage.registers.axis_scale[stage::index_of(Axis::ThetaR)];
  };
  const double before = shown();

  EXPECT_TRUE(bench.instrument.arm(jump, bench.now));

  EXPECT_NEAR(shown() - before, 2.0, 1e-9);
  EXPECT_EQ(bench.instrument.pose(bench.now).positions[stage::index_of(Axis::ThetaR)], 0.0) << "it stands where it was";
}

TEST(LampFaults, AverageAStepOverTheTimeThatItWasThere) {
  LampFaults lamp;
  EXPECT_EQ(lamp.mean(0.0, 10.0), 1.0);
  lamp.step(4.0, 0.5);
  lamp.step(8.0, 1.0);

  EXPECT_NEAR(lamp.mean(0.0, 10.0), 0.8, 1e-15);
  EXPECT_NEAR(lamp.mean(5.0, 6.0), 0.5, 1e-15);
}

}  // namespace
}  // namespace gonio::sim::test
