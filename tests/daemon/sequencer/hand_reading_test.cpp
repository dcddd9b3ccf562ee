// One reading by hand, beside scans that hold or before there is one.
#include <gtest/gtest.h>

#include "daemon/sequencer/sequencer.h"
#include "tests/daemon/sequencer/scan_rig.h"

namespace gonio::daemon {
namespace {

using stage::ShutterState;
using test::bench_plan;
using test::ScanRig;

Instrument with_a_radiometer_as_detector() {
  Instrument instrument = test::bench_instrument();
  const PowerMeterConfig meter{
      .vendor_id = 1, .product_id = 2, .serial = "A", .averages = 1, .sample_time = std::chrono::milliseconds(3)};
  instrument.detector.power = PowerDetectorConfig{.meter = meter, .ranges_w = {1e-3, 1e-4}, .samples = 10};
  return instrument;
}

class ReadingByHand : public testing::Test {
 protected:
  Result<CommandDone> answer(ScanRig& on, Verb verb) {
    const CommandId id = on.command(std::move(verb));
    EXPECT_TRUE(on.run_until([&] { return on.reply_to(id) != nullptr; }));
    return on.reply_to(id)->result;
  }
  void expect_shutters(ShutterState source, ShutterState detector) const {
    EXPECT_EQ(rig.world.stage.source_shutter, source);
    EXPECT_EQ(rig.world.stage.detector_shutter, detector);
  }

  ScanRig rig;
};

TEST_F(ReadingByHand, TellsWhatTheCameraSawAndLeavesTheShuttersAlone) {
  const auto done = answer(rig, ReadDetector{.exposure = std::chrono::milliseconds(16)});

  ASSERT_TRUE(done) << describe(done.error());
  ASSERT_TRUE(done->reading);
  EXPECT_FALSE(done->reading->is_power);
  EXPECT_NEAR(*done->reading->value, rig.world.dark_dn, 1.0) << "the shutters are closed";
  EXPECT_GT(done->reading->noise, 0.0);
  EXPECT_GT(done->reading->values, 1);
  EXPECT_EQ(done->reading->exposure, std::chrono::milliseconds(16));
  EXPECT_FALSE(done->reading->detector_shutter_open);
  EXPECT_EQ(rig.world.exposures, 1);
  EXPECT_EQ(rig.count("SELECT count(*) FROM reading"), 0) << "it is kept nowhere";
}

TEST_F(ReadingByHand, OpensBothShuttersForLightAndPutsThemBack) {
  ShutterState source_then = ShutterState::Closed;
  rig.world.rate_dn_per_s = [&](double, bool) {
    source_then = rig.world.stage.source_shutter;
    return 300'000.0;
  };

  const auto lit = answer(rig, ReadDetector{.exposure = std::chrono::milliseconds(4), .lit = true});
  const auto dark = answer(rig, ReadDetector{.exposure = std::chrono::milliseconds(4), .lit = false});

  ASSERT_TRUE(lit && dark);
  EXPECT_NEAR(*lit->reading->value - *dark->reading->value, 0.004 * 300'000.0, 20.0);
  EXPECT_TRUE(lit->reading->source_shutter_open && lit->reading->detector_shutter_open);
  EXPECT_EQ(source_then, ShutterState::Open);
  expect_shutters(ShutterState::Closed, ShutterState::Closed);
}

TEST_F(ReadingByHand, ClosesTheDetectorsShutterForADarkAndOpensItAgain) {
  ASSERT_TRUE(answer(rig, MoveStage{.source_shutter_open = true, .detector_shutter_open = true}));

  const auto dark = answer(rig, ReadDetector{.lit = false});

  ASSERT_TRUE(dark);
  EXPECT_NEAR(*dark->reading->value, rig.world.dark_dn, 1.0);
  EXPECT_FALSE(dark->reading->detector_shutter_open);
  expect_shutters(ShutterState::Open, ShutterState::Open);
}

TEST_F(ReadingByHand, PutsTheShuttersBackAlsoWhenTheDetectorFails) {
  rig.world.frame_error = [] {
    return std::optional(Error{.code = ErrorCode::TimedOut, .device = "detector", .tried = "fetch the frame"});
  };

  const auto failed = answer(rig, ReadDetector{.lit = true});

  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::TimedOut);
  expect_shutters(ShutterState::Closed, ShutterState::Closed);
  rig.world.frame_error = [] { return std::nullopt; };
  EXPECT_TRUE(answer(rig, ReadDetector{})) << "and the next one is taken";
}

TEST_F(ReadingByHand, IsRefusedWhileAScanMeasuresAndTakenWhileItHolds) {
  const ScanId scan = rig.submit(bench_plan({30}, {10, 20, 60}, {90}));
  ASSERT_TRUE(rig.run_until([&] { return rig.count("SELECT count(*) FROM item") >= 1; }));

  EXPECT_EQ(answer(rig, ReadDetector{}).error().code, ErrorCode::WrongState);
  ASSERT_TRUE(answer(rig, PauseScan{.scan = scan}));
  rig.run_to_rest();
  EXPECT_TRUE(answer(rig, ReadDetector{.lit = true}));
  ASSERT_TRUE(answer(rig, ResumeScan{.scan = scan}));
  rig.run_to_rest();

  EXPECT_EQ(rig.info(scan).state, ScanState::Done);
  EXPECT_EQ(rig.info(scan).counts.accepted, 6);
}

TEST_F(ReadingByHand, IsRefusedBeyondTheDetectorsLimits) {
  const auto beyond = answer(rig, ReadDetector{.exposure = std::chrono::hours(1)});
  const auto range = answer(rig, ReadDetector{.range_w = 1e-3});

  EXPECT_EQ(beyond.error().code, ErrorCode::OutOfLimits);
  EXPECT_EQ(range.error().code, ErrorCode::InvalidInput) << "a camera has no ranges";
  EXPECT_EQ(rig.world.exposures, 0);
}

TEST_F(ReadingByHand, OfARadiometerIsAPowerInTheRangeAskedFor) {
  ScanRig meter{with_a_radiometer_as_detector()};

  const auto usual = answer(meter, ReadDetector{.lit = true});
  const auto fine = answer(meter, ReadDetector{.range_w = 1e-4, .lit = true});
  const auto none = answer(meter, ReadDetector{.range_w = 5e-4});

  ASSERT_TRUE(usual && fine);
  EXPECT_TRUE(usual->reading->is_power);
  EXPECT_EQ(usual->reading->full_scale, 1e-3) << "the largest";
  EXPECT_EQ(fine->reading->full_scale, 1e-4);
  EXPECT_NEAR(*fine->reading->value, meter.world.zero_w + 4e-5, 1e-12);
  EXPECT_NEAR(fine->reading->noise, 1e-9 * std::sqrt(10.0), 1e-15) << "of one sample";
  EXPECT_EQ(in_nanometres(*fine->reading->wavelength), 568.0);
  EXPECT_EQ(none.error().code, ErrorCode::OutOfLimits);
}

TEST_F(ReadingByHand, OfARadiometerInOverloadHasNoValue) {
  ScanRig meter{with_a_radiometer_as_detector()};
  meter.world.power_w = [](double, bool) { return 1.0; };

  const auto over = answer(meter, ReadDetector{.lit = true});

  ASSERT_TRUE(over);
  EXPECT_FALSE(over->reading->value);
  EXPECT_EQ(over->reading->saturated, 1);
}

}  // namespace
}  // namespace gonio::daemon
