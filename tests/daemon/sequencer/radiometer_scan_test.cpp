// Scans with a radiometer in the camera's place, or in the lamp's light.
#include <gtest/gtest.h>

#include "daemon/sequencer/sequencer.h"
#include "tests/daemon/sequencer/scan_rig.h"

namespace gonio::daemon {
namespace {

using test::bench_plan;
using test::ScanRig;

PowerMeterConfig meter(const std::string& serial) {
  return {
      .vendor_id = 1, .product_id = 2, .serial = serial, .averages = 1, .sample_time = std::chrono::milliseconds(3)};
}

Instrument with_monitor(Instrument instrument = test::bench_instrument()) {
  instrument.monitor = PowerMonitorConfig{.meter = meter("B"), .wavelength = nanometres(568.0), .range_w = 1e-2};
  instrument.lamp = {.low = 2e-4, .high = 5e-3};
  return instrument;
}

Instrument with_radiometer() {
  Instrument instrument = test::bench_instrument();
  PowerDetectorConfig power{.meter = meter("A"), .ranges_w = {1e-3, 1e-4, 1e-5}, .samples = 10, .zero = true};
  instrument.detector = {.serial = "A",
                         .shortest_exposure = power.reading_time(),
                         .longest_exposure = power.reading_time(),
                         .frames_at_most = 16,
                         .power = power};
  instrument.model.detector = {.full_scale_dn = 1.0, .power = calibration::PowerModel{.noise = 1e-4}};
  return with_monitor(instrument);
}

class RadiometerScan : public testing::Test {
 protected:
  ScanId run(const api::Plan& plan) {
    const ScanId id = rig.submit(plan);
    rig.run_to_rest();
    return id;
  }
  std::int64_t count(const std::string& query) { return rig.count(query); }

  ScanRig rig{with_radiometer()};
};

class MonitoredScan : public testing::Test {
 protected:
  ScanRig rig{with_monitor()};
};

TEST_F(RadiometerScan, MeasuresEveryItemWithBothMetersBesideEachReading) {
  const ScanId id = run(bench_plan({30}, {10, 20, 60}, {90}));

  const ScanInfo info = rig.info(id);
  EXPECT_EQ(info.state, ScanState::Done);
  EXPECT_EQ(info.counts.accepted, 6);
  EXPECT_EQ(count("SELECT count(*) FROM reading"), rig.world.exposures) << "every reading is stored";
  EXPECT_EQ(count("SELECT count(*) FROM power_reading WHERE role = 'detector'"), rig.world.exposures);
  EXPECT_EQ(count("SELECT count(*) FROM power_reading WHERE role = 'monitor'"), rig.world.monitor_readings);
  EXPECT_EQ(count("SELECT count(*) FROM reading WHERE monitor_mean <> 1e-3 OR gate_count <> 0"), 0);
  EXPECT_EQ(count("SELECT count(*) FROM reading WHERE attempt_id > 0 AND open_theta_i_counts <> 300000"), 0)
      << "the encoders of the look before stand for a gate's";
}

TEST_F(RadiometerScan, ZeroesOnceInTheDarkBeforeItsFirstDark) {
  run(bench_plan({30}, {10, 20}, {90}));

  EXPECT_EQ(rig.world.zeros, 1);
  EXPECT_TRUE(rig.world.zeroed_in_the_dark);
}

TEST_F(RadiometerScan, TakesTheRangeThatHoldsTheLightWithADarkOfItsOwnBeforeAndAfter) {
  run(bench_plan({30}, {10, 20}, {90}));

  EXPECT_EQ(
      count("SELECT count(*) FROM power_reading JOIN reading USING (reading_id) WHERE attempt_id > 0 AND used = 1 "
            "AND role = 'detector' AND range_w <> 1e-4"),
      0)
      << "40 uW: more than 10 uW, less than half of 100 uW";
  EXPECT_EQ(
      count("SELECT count(DISTINCT visit_id) FROM power_reading JOIN reading USING (reading_id) WHERE visit_id > 0 "
            "AND role = 'detector' AND range_w = 1e-4"),
      2);
}

TEST_F(RadiometerScan, GoesToALargerRangeAfterAnOverloadWhichIsNeverUsed) {
  rig.world.power_w = [](double, bool is_reference) { return is_reference ? 4e-4 : 4e-5; };

  const ScanId id = run(bench_plan({30}, {10}, {90}));

  EXPECT_EQ(rig.info(id).counts.accepted, 2);
  EXPECT_EQ(count("SELECT count(*) FROM reading WHERE saturated > 0 AND used = 1"), 0);
  EXPECT_EQ(count("SELECT count(*) FROM power_reading JOIN reading USING (reading_id) JOIN attempt USING (attempt_id) "
                  "WHERE target = 'reference' AND used = 1 AND role = 'detector' AND range_w <> 1e-3"),
            0);
}

TEST_F(RadiometerScan, RefusesAReadingDuringWhichTheStageWasNotWhereItShouldBe) {
  int disturbances = 1;
  rig.world.during_reading = [&] {
    const bool is_lit = rig.world.stage.detector_shutter == stage::ShutterState::Open;
    if (is_lit && disturbances-- > 0) rig.world.stage.axes[stage::index_of(stage::Axis::ThetaR)].position += 0.5;
  };

  const ScanId id = run(bench_plan({30}, {10, 20}, {90}));

  EXPECT_EQ(rig.info(id).counts.accepted, 4) << "the next try goes there again";
  EXPECT_EQ(count("SELECT count(*) FROM attempt WHERE outcome = 'failed' AND error_code = 'out-of-tolerance'"), 1);
}

TEST_F(RadiometerScan, TriesAgainAfterTheMonitorDidNotAnswer) {
  int failures = 1;
  rig.world.monitor_error = [&]() -> std::optional<Error> {
    if (rig.world.exposures < 12 || failures-- <= 0) return std::nullopt;
    return Error{.code = ErrorCode::TimedOut, .device = "monitor", .tried = "read", .seen = "nothing"};
  };

  const ScanId id = run(bench_plan({30}, {10, 20}, {90}));

  EXPECT_EQ(rig.info(id).counts.accepted, 4);
  EXPECT_EQ(count("SELECT count(*) FROM attempt WHERE outcome = 'failed' AND error_code = 'timed-out'"), 1);
}

TEST_F(RadiometerScan, HoldsWhenTheMonitorSaysThatTheLampIsOut) {
  const ScanId id = rig.submit(bench_plan({30}, {10, 20}, {90}));
  ASSERT_TRUE(rig.run_until([&] { return count("SELECT count(*) FROM item") >= 1; }));
  rig.world.monitor_w = 1e-6;

  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  EXPECT_EQ(count("SELECT count(*) FROM hold WHERE name = 'lamp'"), 1);
}

TEST_F(RadiometerScan, GoesOnAfterBeingKilledWithADarkInEveryRange) {
  rig.submit(bench_plan({30}, {10, 20}, {90}));
  ASSERT_TRUE(rig.run_until([&] { return count("SELECT count(*) FROM item") >= 1; }));

  rig.kill();
  rig.start();
  rig.run_to_rest();

  EXPECT_EQ(count("SELECT count(*) FROM item WHERE outcome = 'accepted'"), 4);
  EXPECT_EQ(rig.world.zeros, 2) << "once a run";
}

TEST_F(MonitoredScan, StoresTheRadiometersWordInsteadOfTheStagesBesideACamera) {
  const ScanId id = rig.submit(bench_plan({30}, {10, 20}, {90}));

  rig.run_to_rest();

  EXPECT_EQ(rig.info(id).counts.accepted, 4);
  EXPECT_EQ(rig.count("SELECT count(*) FROM power_reading WHERE role = 'monitor'"), rig.world.exposures);
  EXPECT_EQ(rig.count("SELECT count(*) FROM power_reading WHERE role = 'detector'"), 0);
  EXPECT_EQ(rig.count("SELECT count(*) FROM reading WHERE monitor_mean <> 1e-3"), 0);
  EXPECT_EQ(rig.count("SELECT count(*) FROM reading WHERE gate_count = 0"), 0) << "the camera still gates the stage";
}

}  // namespace
}  // namespace gonio::daemon
