#include "daemon/planner/exposure_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/planner/exposure_ladder.h"
#include "daemon/sequencer/measurement.h"
#include "tests/daemon/support/scan_records.h"

namespace gonio::daemon {
namespace {

using calibration::Target;
using std::chrono::milliseconds;

ReadingLimits policy(double snr, Duration max_time = std::chrono::seconds(1)) {
  return ReadingLimits{.target_snr = snr, .max_time = max_time};
}

TEST(ExposureChooser, TheLadderGoesByTwosUpToTheDetectorsAndThePlansLongest) {
  const ExposureChooser by_detector(test::bench_instrument(), policy(300));
  const ExposureChooser by_plan(test::bench_instrument(), policy(300, milliseconds(10)));

  EXPECT_EQ(by_detector.rungs().size(), 7U);
  EXPECT_EQ(by_detector.rungs().back(), milliseconds(64));
  EXPECT_EQ(by_plan.rungs().back(), milliseconds(8));
}

TEST(ExposureChooser, FramesFollowFromThePhotonTransferModel) {
  // By hand: 8 ms at 10 000 DN/s are 80 DN in 25 pixels. Variance of the mean: (80/4 + 2 * 1.5^2) / 25 = 0.98 DN^2, so
  // one frame has a signal-to-noise of 80 / 0.98995 = 80.81; 300 needs (300 / 80.81)^2 = 13.8 frames.
  const ExposureChooser chooser(test::bench_instrument(), policy(300));

  EXPECT_EQ(chooser.frames_needed(3, {10'000.0, 25}), 14);
  EXPECT_TRUE(chooser.reaches(3, {10'000.0, 25}));
  EXPECT_FALSE(chooser.reaches(0, {10'000.0, 25})) << "1 ms: 112 frames and more, 16 allowed";
}

TEST(ExposureChooser, TheChosenRungStaysBelowHalfOfFullScale) {
  const ExposureChooser chooser(test::bench_instrument(), policy(1e6));

  for (const double rate : {1e3, 1e4, 1e5, 1e6}) {
    const ExposurePlan plan = chooser.choose({rate, 450}, 6);
    const double level = rate * in_seconds(chooser.rungs()[plan.rung]);
    EXPECT_TRUE(level <= 0.5 * 4095 || plan.rung == 0) << rate;
    EXPECT_TRUE(plan.rung == 6 || 2.0 * level > 0.5 * 4095) << "no light is left unused: " << rate;
  }
}

TEST(ExposureChooser, ASignalLostInTheNoiseGetsTheLongestExposureAndAllFrames) {
  const ExposureChooser chooser(test::bench_instrument(), policy(300));

  const ExposurePlan plan = chooser.choose({-5.0, 450}, 6);

  EXPECT_EQ(plan.rung, 6U);
  EXPECT_EQ(plan.frames, 15) << "1 s over 64 ms";
}

// Feeds frames of a constant light; the number of exposures until done.
struct Light {
  double rate;
  Measurement::Verdict verdict = Measurement::Verdict::More;
  int exposures = 0;
  void shine_on(Measurement& item, ExposureChooser& chooser) {
    while (verdict == Measurement::Verdict::More && exposures < 100) {
      const double level = 100.0 + rate * in_seconds(chooser.rungs()[item.rung()]);
      ReadingRecord reading = test::reading_of(std::min(level, 4095.0), Instant{}, chooser.rungs()[item.rung()]);
      reading.region.saturated = level > 4095.0 ? 10 : 0;
      verdict = item.add(reading, chooser);
      ++exposures;
    }
  }
};

ExposureChooser chooser_with_dark(double snr) {
  ExposureChooser chooser(test::bench_instrument(), policy(snr));
  for (std::size_t rung = 0; rung < chooser.rungs().size(); ++rung) chooser.learn_dark(rung, 100.0);
  return chooser;
}

TEST(Measurement, TheNextItemNeedsNoProbe) {
  ExposureChooser chooser = chooser_with_dark(300);
  Measurement first = Measurement::of_item(chooser, Target::Sample, 1);
  Light{2e5}.shine_on(first, chooser);

  Measurement second = Measurement::of_item(chooser, Target::Sample, 1);
  Light light{2.1e5};
  light.shine_on(second, chooser);

  EXPECT_EQ(light.verdict, Measurement::Verdict::Done);
  EXPECT_EQ(static_cast<int>(second.readings().size()), second.used_frames());
}

TEST(Measurement, SaturationDropsARungAndItsFramesAreNeverUsed) {
  ExposureChooser chooser = chooser_with_dark(100);
  chooser.remember(Target::Sample, 1, {1e4, 450});
  Measurement item = Measurement::of_item(chooser, Target::Sample, 1);
  Light glint{1.5e6};

  glint.shine_on(item, chooser);

  EXPECT_EQ(glint.verdict, Measurement::Verdict::Done);
  for (const ReadingRecord& reading : item.readings()) {
    EXPECT_FALSE(reading.used && reading.region.saturated > 0);
  }
  EXPECT_GE(item.used_frames(), 1);
}

TEST(Measurement, SaturationAtTheShortestExposureIsTheItemsError) {
  ExposureChooser chooser = chooser_with_dark(100);
  Measurement item = Measurement::of_item(chooser, Target::Sample, 1);
  Light sun{1e8};

  sun.shine_on(item, chooser);

  EXPECT_EQ(sun.verdict, Measurement::Verdict::Saturated);
  EXPECT_LE(sun.exposures, 4);
}

TEST(Measurement, ADarkReadsEachRungSoManyTimesAndTeachesItsLevel) {
  ExposureChooser chooser(test::bench_instrument(), policy(300));
  Measurement dark = Measurement::of_dark(1, 3, 4);
  Measurement::Verdict verdict = Measurement::Verdict::More;
  int exposures = 0;
  while (verdict == Measurement::Verdict::More && exposures < 100) {
    verdict = dark.add(test::reading_of(90.0 + static_cast<double>(dark.rung()), Instant{}), chooser);
    ++exposures;
  }

  EXPECT_EQ(exposures, 12);
  EXPECT_EQ(chooser.dark_dn(1), 91.0);
  EXPECT_EQ(chooser.dark_dn(3), 93.0);
}

TEST(Measurement, EveryLightEndsWithinABoundedNumberOfExposures) {
  for (double rate = 1e-2; rate < 1e9; rate *= 1.7) {
    ExposureChooser chooser = chooser_with_dark(500);
    Measurement item = Measurement::of_item(chooser, Target::Reference, 1);
    Light light{rate};
    light.shine_on(item, chooser);
    EXPECT_NE(light.verdict, Measurement::Verdict::More) << rate;
    EXPECT_LE(light.exposures, 16 + 12) << rate;
  }
}

ReadingLimits bracketed(std::vector<Duration> exposures, double snr, Duration max_time = std::chrono::seconds(1)) {
  return ReadingLimits{.target_snr = snr, .max_time = max_time, .exposures = std::move(exposures)};
}

ExposureChooser stated_chooser(const ReadingLimits& policy) {
  ExposureChooser chooser(test::bench_instrument(), policy);
  for (std::size_t rung = 0; rung < chooser.rungs().size(); ++rung) chooser.learn_dark(rung, 100.0);
  return chooser;
}

int used_readings(const Measurement& item) {
  return static_cast<int>(std::ranges::count_if(item.readings(), [](const ReadingRecord& r) { return r.used; }));
}

TEST(StatedExposures, EachIsUsedOnceAndTheLongestUntilTheSignalToNoiseIsReached) {
  ExposureChooser chooser = stated_chooser(bracketed({milliseconds(1), milliseconds(8), milliseconds(32)}, 300));
  Measurement item = Measurement::of_item(chooser, Target::Sample, 1);
  Light light{10'000.0};

  light.shine_on(item, chooser);

  // By hand, 32 ms: 320 DN of 450 pixels; variance (320/4 + 4.5) / 450 = 0.1878: one frame has 738, more than 300.
  EXPECT_EQ(light.verdict, Measurement::Verdict::Done);
  EXPECT_EQ(item.used_rungs(), (std::vector<std::size_t>{0, 3, 5}));
  EXPECT_EQ(light.exposures, 3);
  EXPECT_EQ(used_readings(item), 3);
}

TEST(StatedExposures, ABrightPeakKeepsTheShortOnesAndNoFrameOfARungThatSaturated) {
  ExposureChooser chooser = stated_chooser(bracketed({milliseconds(1), milliseconds(8), milliseconds(32)}, 4000));
  Measurement item = Measurement::of_item(chooser, Target::Sample, 1);
  Light light{400'000.0};  // 8 ms: 3300 DN; 32 ms: beyond full scale

  light.shine_on(item, chooser);

  EXPECT_EQ(light.verdict, Measurement::Verdict::Done);
  EXPECT_EQ(item.used_rungs(), (std::vector<std::size_t>{0, 3}));
  for (const ReadingRecord& reading : item.readings()) EXPECT_NE(reading.used, reading.region.saturated > 0);
  EXPECT_GT(item.used_frames(), 1) << "what is left of the target is made up by more frames";
}

TEST(StatedExposures, ARungThatSaturatesOnlyNowAndThenIsLeftOutWhole) {
  ExposureChooser chooser = stated_chooser(bracketed({milliseconds(1), milliseconds(8)}, 1e5));
  Measurement item = Measurement::of_item(chooser, Target::Sample, 1);
  auto verdict = item.add(test::reading_of(500.0, Instant{}, milliseconds(1)), chooser);
  verdict = item.add(test::reading_of(3300.0, Instant{}, milliseconds(8)), chooser);
  ASSERT_EQ(verdict, Measurement::Verdict::More);

  ReadingRecord bright = test::reading_of(3301.0, Instant{}, milliseconds(8));
  bright.region.saturated = 1;
  (void)item.add(bright, chooser);

  EXPECT_EQ(item.used_rungs(), (std::vector<std::size_t>{0}));
  EXPECT_EQ(item.rung(), 0U);
  EXPECT_EQ(used_readings(item), 1);
}

TEST(StatedExposures, TheTimeOfAReadingBoundsTheRepeats) {
  ExposureChooser chooser = stated_chooser(bracketed({milliseconds(16), milliseconds(32)}, 1e6, milliseconds(150)));
  Measurement item = Measurement::of_item(chooser, Target::Sample, 1);
  Light light{10'000.0};

  light.shine_on(item, chooser);

  EXPECT_EQ(light.exposures, 5) << "16 ms + 4 * 32 ms = 144 ms of 150";
  EXPECT_EQ(light.verdict, Measurement::Verdict::Done);
}

const std::vector<Duration> kUpAndDown{milliseconds(1),  milliseconds(8), milliseconds(32),
                                       milliseconds(32), milliseconds(8), milliseconds(1)};

std::vector<Duration> used_exposures(const Measurement& item) {
  std::vector<Duration> exposures;
  for (std::size_t k = 0; k < item.readings().size(); ++k) {
    if (item.readings()[k].used) exposures.push_back(milliseconds(1) * (1U << item.rung_of(k)));
  }
  return exposures;
}

TEST(StatedExposures, ThatComeDownAgainAreGoneThroughOnceWhateverTheSignalToNoise) {
  ExposureChooser chooser = stated_chooser(bracketed(kUpAndDown, 1e6));
  Measurement item = Measurement::of_item(chooser, Target::Sample, 1);
  Light light{10'000.0};

  light.shine_on(item, chooser);

  EXPECT_EQ(light.verdict, Measurement::Verdict::Done);
  EXPECT_EQ(used_exposures(item), kUpAndDown);
}

TEST(StatedExposures, ThatComeDownAgainTurnBelowWhatSaturates) {
  ExposureChooser chooser = stated_chooser(bracketed(kUpAndDown, 300));
  Measurement item = Measurement::of_item(chooser, Target::Sample, 1);
  Light light{400'000.0};  // 8 ms: 3300 DN; 32 ms: beyond full scale

  light.shine_on(item, chooser);

  EXPECT_EQ(light.verdict, Measurement::Verdict::Done);
  EXPECT_EQ(used_exposures(item),
            (std::vector<Duration>{milliseconds(1), milliseconds(8), milliseconds(8), milliseconds(1)}));
  EXPECT_EQ(light.exposures, 5) << "one saw that 32 ms are too long";
}

TEST(StatedExposures, OfOneThatSaturatesTheItemSaysSo) {
  ExposureChooser chooser = stated_chooser(bracketed({milliseconds(32)}, 300));
  Measurement item = Measurement::of_item(chooser, Target::Sample, 1);
  Light light{400'000.0};

  light.shine_on(item, chooser);

  EXPECT_EQ(light.verdict, Measurement::Verdict::Saturated);
  EXPECT_EQ(light.exposures, 1);
  EXPECT_TRUE(item.used_rungs().empty());
}

TEST(ExposureLadder, RefusesAStatedExposureThatIsNoneOfTheDetectorsAndNamesThoseBesideIt) {
  const std::vector<Duration> ladder = exposure_ladder(test::bench_instrument().detector, std::chrono::seconds(1));

  const auto between = rungs_of({milliseconds(6)}, ladder);
  const auto beyond = rungs_of({std::chrono::seconds(1)}, ladder);
  const auto rounded = rungs_of({std::chrono::microseconds(8'030)}, ladder);

  ASSERT_FALSE(between);
  EXPECT_EQ(between.error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(between.error().seen, "0.006 s");
  EXPECT_EQ(between.error().limit, "0.004 s or 0.008 s");
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().limit, "0.064 s or shorter");
  ASSERT_TRUE(rounded);
  EXPECT_EQ(rounded->front(), 3U);
}

// A peak a thousand times as bright as its flank, with a dark hole: no chosen exposure may use a saturated frame, and
// each reaches the target where the light allows it.
TEST(ExposureChooser, AcrossAPeakAndItsFlanksNoSaturatedFrameCounts) {
  ExposureChooser chooser = chooser_with_dark(300);
  for (const double rate : {2e3, 2e6, 2e3, 3e5, 50.0, 2e6, 3e5, 2e3}) {
    SCOPED_TRACE(rate);
    Measurement item = Measurement::of_item(chooser, Target::Sample, 1);
    Light light{rate};

    light.shine_on(item, chooser);

    ASSERT_EQ(light.verdict, Measurement::Verdict::Done);
    EXPECT_LE(light.exposures, 40);
    double electrons = 0.0;
    for (const ReadingRecord& reading : item.readings()) {
      if (!reading.used) continue;
      EXPECT_EQ(reading.region.saturated, 0U);
      electrons += (reading.region.mean - 100.0) * 4.0 * reading.region.n;
    }
    if (rate < 1e3) continue;  // a hole too dark for the time of a reading
    EXPECT_GE(std::sqrt(electrons), 300.0) << "shot noise alone allows the target";
  }
}

}  // namespace
}  // namespace gonio::daemon
