#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reflectance/direction/direction.h"
#include "tests/sim/bench.h"

namespace gonio::sim::test {
namespace {

constexpr double kNearly = 1e-9;  // of electrons, relative: sums of a few hundred doubles

Bench lit_bench(Scene scene = quiet_scene()) {
  return Bench(std::move(scene));
}

void make_ready(Bench& bench, double theta_i_deg) {
  bench.home();
  bench.open_shutters();
  bench.move(Axis::ThetaI, theta_i_deg);
  bench.wait(20.0);
}

// What the quiet scene's Lambertian sample gives: pi f cos(theta_i) electrons_per_s t.
double expected_electrons(double theta_i_deg, double exposure_s) {
  return 700000.0 * 0.5 * std::cos(theta_i_deg * std::numbers::pi / 180.0) * exposure_s;
}

TEST(Exposure, CollectsRadianceTimesTheCosineOfIncidence) {
  Bench bench = lit_bench();
  make_ready(bench, 60.0);

  const Exposure exposure = bench.expose(0.02);

  EXPECT_NEAR(exposure.light_electrons / expected_electrons(60.0, 0.02), 1.0, kNearly);
}

TEST(Exposure, SeesNoLightWithEitherShutterClosed) {
  for (const Field shutter : {Field::SourceShutterCommand, Field::DetectorShutterCommand}) {
    Bench bench = lit_bench();
    make_ready(bench, 30.0);

    bench.write(shutter, 0);

    EXPECT_EQ(bench.expose(0.02).light_electrons, 0.0);
  }
}

TEST(Exposure, CollectsDarkElectronsWhateverTheShuttersDo) {
  Scene scene = quiet_scene();
  scene.detector.dark_dn_per_s = 8.0;
  Bench bench = lit_bench(scene);

  EXPECT_NEAR(bench.expose(0.5).dark_electrons, 8.0 * 4.0 * 0.5, kNearly);
}

TEST(Exposure, SeesNoLightBetweenTheStationsAndBeforeTheTrap) {
  for (const double carriage_mm : {60.0, 240.0}) {
    Bench bench = lit_bench();
    make_ready(bench, 30.0);

    bench.move(Axis::Carriage, carriage_mm);
    bench.wait(20.0);

    EXPECT_EQ(bench.expose(0.02).light_electrons, 0.0) << carriage_mm;
  }
}

TEST(Exposure, SeesTheReferenceWhenTheCarriageStandsThere) {
  Bench bench = lit_bench();
  make_ready(bench, 30.0);
  bench.move(Axis::Carriage, 120.0);
  bench.wait(20.0);

  const Exposure exposure = bench.expose(0.02);

  const double reff = exposure.light_electrons / (700000.0 * 0.02 * std::cos(std::numbers::pi / 6.0));
  EXPECT_NEAR(reff, 1.0, 0.08) << "99 % Spectralon, near normal";
}

TEST(Exposure, CountsOnlyTheTimeForWhichAShutterIsOpen) {
  Scene scene = quiet_scene();
  scene.stage.shutter_s = 0.1;
  Bench bench = lit_bench(scene);
  make_ready(bench, 0.0);
  bench.write(Field::SourceShutterCommand, 0);
  bench.wait(1.0);

  bench.write(Field::SourceShutterCommand, 1);  // open 0.1 s from now
  const Exposure exposure = bench.expose(0.4);

  EXPECT_NEAR(exposure.light_electrons / expected_electrons(0.0, 0.3), 1.0, kNearly);
}

TEST(Exposure, StopsCollectingWhenTheShutterBeginsToClose) {
  Scene scene = quiet_scene();
  scene.stage.shutter_s = 0.1;
  Bench bench = lit_bench(scene);
  make_ready(bench, 0.0);
  bench.wait(1.0);

  ASSERT_TRUE(bench.camera.set_exposure(seconds(0.4)).has_value());
  ASSERT_TRUE(bench.camera.trigger(bench.now));
  bench.wait(0.25);
  bench.write(Field::DetectorShutterCommand, 0);
  bench.wait(0.2);
  const auto exposure = bench.camera.collect_exposure(bench.now);

  ASSERT_TRUE(exposure.has_value());
  EXPECT_NEAR(exposure->light_electrons / expected_electrons(0.0, 0.25), 1.0, kNearly);
}

// The position of an arm that has started from rest, written down anew: 20 deg/s, 40 deg/s2.
double arm_deg(double from, double to, double t) {
  const double way = to - from;
  const double end = way / 20.0 + 0.5;
  if (t <= 0.5) return from + 20.0 * t * t;
  if (t < end - 0.5) return from + 5.0 + 20.0 * (t - 0.5);
  return t < end ? to - 20.0 * (end - t) * (end - t) : to;
}

TEST(Exposure, AveragesOverTheMotionAsAnIndependentIntegralDoes) {
  Bench bench = lit_bench();
  make_ready(bench, 20.0);
  bench.move(Axis::ThetaI, 70.0);
  bench.wait(0.8);

  const Exposure exposure = bench.expose(0.5);

  // Midpoint rule with 1e5 steps: error below 1e-9.
  double sum = 0.0;
  constexpr int kSteps = 100000;
  for (int k = 0; k < kSteps; ++k) {
    const double theta = arm_deg(20.0, 70.0, 0.8 + 0.5 * (k + 0.5) / kSteps);
    sum += expected_electrons(theta, 0.5 / kSteps);
  }
  EXPECT_NEAR(exposure.light_electrons / sum, 1.0, 1e-8);
  EXPECT_GT(std::abs(exposure.light_electrons / expected_electrons(arm_deg(20.0, 70.0, 0.8), 0.5) - 1.0), 0.01)
      << "leaving too early must show";
}

TEST(Exposure, FollowsAnArmThatIsHaltedInTheMiddle) {
  Bench bench = lit_bench();
  make_ready(bench, 20.0);
  bench.move(Axis::ThetaI, 70.0);
  bench.wait(1.0);
  ASSERT_TRUE(bench.camera.set_exposure(seconds(0.5)).has_value());
  ASSERT_TRUE(bench.camera.trigger(bench.now));
  bench.wait(0.1);
  bench.halt(1);
  bench.wait(0.5);

  const auto exposure = bench.camera.collect_exposure(bench.now);

  // 20 deg/s for 0.1 s from 35 deg on, then braking at 40 deg/s2 for 0.4 s of its 0.5 s.
  double sum = 0.0;
  constexpr int kSteps = 100000;
  for (int k = 0; k < kSteps; ++k) {
    const double t = 0.5 * (k + 0.5) / kSteps;
    const double braking = std::max(0.0, t - 0.1);
    sum += expected_electrons(35.0 + 20.0 * t - 20.0 * braking * braking, 0.5 / kSteps);
  }
  ASSERT_TRUE(exposure.has_value());
  EXPECT_NEAR(exposure->light_electrons / sum, 1.0, 1e-8);
}

TEST(Exposure, LatchesTheEncodersWhenTheGateOpensAndCloses) {
  Bench bench = lit_bench();
  make_ready(bench, 20.0);
  bench.move(Axis::ThetaI, 70.0);
  bench.wait(1.0);
  (void)bench.expose(0.5);
  bench.wait(10.0);  // looked at much later

  const double scale = bench.map().axis_scale[stage::index_of(Axis::ThetaI)];
  const auto open = bench.value(bench.map().at(Axis::ThetaI, AxisField::GateOpenEncoder));
  const auto close = bench.value(bench.map().at(Axis::ThetaI, AxisField::GateCloseEncoder));
  EXPECT_NEAR(static_cast<double>(open) * scale, 35.0, 1e-4);
  EXPECT_NEAR(static_cast<double>(close) * scale, 45.0, 1e-4);
  EXPECT_EQ(bench.value(Field::GateCount), 1);
  EXPECT_EQ(bench.value(Field::GateState), 0);
}

TEST(Exposure, ShowsTheGateAsOpenWhileItIs) {
  Bench bench = lit_bench();
  ASSERT_TRUE(bench.camera.set_exposure(seconds(0.5)).has_value());
  ASSERT_TRUE(bench.camera.trigger(bench.now));
  bench.wait(0.25);

  EXPECT_EQ(bench.value(Field::GateState), 1);
  EXPECT_EQ(bench.value(Field::GateCount), 1);
  EXPECT_FALSE(bench.camera.trigger(bench.now)) << "one exposure at a time";
}

TEST(Exposure, AveragesTheMonitorOverExactlyItself) {
  Scene scene = quiet_scene();
  scene.lamp.power = 2.0;
  scene.lamp.drift_per_hour = 0.36;  // 1e-4 a second
  scene.lamp.wave = 0.1;
  scene.lamp.wave_period_s = 1.0;
  Bench bench = lit_bench(scene);
  bench.wait(5.0);

  (void)bench.expose(0.5);
  const double whole = static_cast<double>(bench.value(Field::GateMonitorMean)) * bench.map().monitor_scale;
  bench.wait(0.5);
  (void)bench.expose(0.5);
  const double again = static_cast<double>(bench.value(Field::GateMonitorMean)) * bench.map().monitor_scale;

  // One period later the wave is the same, so only the drift is left, whatever the wave's phase.
  EXPECT_NEAR(again - whole, 2.0 * 1e-4 * 1.0, 2e-7);
}

TEST(Exposure, HasTheSameLightWithAllEffectsNamedAsZero) {
  Scene named = quiet_scene();
  named.lamp.flicker = 0.0;
  named.lamp.wave = 0.0;
  named.lamp.u_after_monitor = 0.0;
  named.lamp.flicker_cell_s = 0.5;
  named.lamp.wave_period_s = 3.0;
  named.lamp.correlation_s = 1.0;
  named.lamp.monitor_rate_hz = 10.0;
  named.draws_errors = true;  // from uncertainties of zero
  named.reference.modes.clear();
  named.seed = 99;
  named.reference.certificate[0].uncertainty = 0.0;
  Bench plain = lit_bench();
  Bench other = lit_bench(named);
  make_ready(plain, 40.0);
  make_ready(other, 40.0);

  EXPECT_EQ(plain.expose(0.1).light_electrons, other.expose(0.1).light_electrons);
}

TEST(Exposure, KeepsItsNoiseWhenAnotherEffectIsSwitchedOn) {
  Scene quiet = quiet_scene();
  Scene flickering = quiet_scene();
  flickering.lamp.monitor_noise = 0.01;
  flickering.angles.u_repeat = degrees(0.1);
  const Exposure exposure{.number = 5, .light_electrons = 4000.0, .dark_electrons = 0.0};

  EXPECT_EQ(render_frame(quiet.detector, exposure, quiet.seed),
            render_frame(flickering.detector, exposure, flickering.seed));
}

TEST(Exposure, IsCountedByWhereTheStageStood) {
  Bench bench = lit_bench();
  make_ready(bench, 30.0);

  (void)bench.expose(0.1);
  (void)bench.expose(0.1);
  bench.write(Field::DetectorShutterCommand, 0);
  (void)bench.expose(0.1);

  const InstrumentMemory memory = bench.instrument.memory(bench.now);
  EXPECT_EQ(memory.exposures, 3U);
  EXPECT_EQ(memory.lit_exposures, 2U);
  EXPECT_EQ(memory.places.at({.station = Station::Sample, .centidegrees = {3000, 0, 0}, .is_lit = true}), 2U);
}

}  // namespace
}  // namespace gonio::sim::test
