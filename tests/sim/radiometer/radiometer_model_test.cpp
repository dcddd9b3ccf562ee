#include "sim/devices/radiometer_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/bench.h"

namespace gonio::sim::test {
namespace {

constexpr double kNearly = 1e-9;  // relative: sums of a few hundred doubles

/// A radiometer before the quiet scene's sample, with REFF 0.5 at theta_i = 60 deg: light 0.25, 0.25 mW of 1 mW.
class RadiometerModelTest : public testing::Test {
 protected:
  explicit RadiometerModelTest(RadiometerSpec the_spec = quiet_radiometer(), Scene scene = quiet_scene())
      : bench(std::move(scene)), meter(bench.instrument, std::move(the_spec)) {
    bench.home();
    bench.open_shutters();
    bench.move(Axis::ThetaI, 60.0);
    bench.wait(20.0);
    EXPECT_TRUE(meter.set_wavelength(nanometres(568.0)));
    EXPECT_TRUE(meter.set_range(1e-3, bench.now));
  }
  RadiometerSample sample() {
    meter.start_sample(bench.now);
    for (int k = 0; k < 10; ++k) {
      bench.now = meter.due().value_or(bench.now);
      if (const auto taken = meter.take_sample(bench.now)) return *taken;
    }
    ADD_FAILURE() << "no sample";
    return {};
  }
  bool zero() {
    meter.start_zero(bench.now);
    bench.now = meter.due().value_or(bench.now);
    return meter.take_zero(bench.now).value();
  }

  Bench bench;
  RadiometerModel meter;
};

TEST_F(RadiometerModelTest, ShowsThePowerOfTheLightFromTheSample) {
  EXPECT_NEAR(sample().power_w, 0.25e-3, kNearly * 0.25e-3);
}

TEST_F(RadiometerModelTest, ShowsNothingBehindAClosedShutter) {
  bench.write(Field::DetectorShutterCommand, 0);

  EXPECT_EQ(sample().power_w, 0.0);
}

TEST_F(RadiometerModelTest, CollectsTheLightUntilTheShutterCloses) {
  ASSERT_TRUE(meter.set_averages(100));
  meter.start_sample(bench.now);
  bench.wait(0.15);
  bench.write(Field::DetectorShutterCommand, 0);
  bench.wait(0.15);

  const auto taken = meter.take_sample(bench.now);

  ASSERT_TRUE(taken);
  EXPECT_NEAR(taken->power_w, 0.125e-3, 1e-6 * 0.125e-3) << "150 ms of 300 ms";
}

TEST_F(RadiometerModelTest, LeavesAnExposureBesideItAlone) {
  const double alone = bench.expose(0.02).light_electrons;

  ASSERT_TRUE(bench.camera.set_exposure(seconds(0.02)));
  ASSERT_TRUE(bench.camera.trigger(bench.now));
  bench.wait(0.005);
  const double power_w = sample().power_w;
  bench.wait(0.02);

  EXPECT_NEAR(bench.camera.collect_exposure(bench.now)->light_electrons, alone, kNearly * alone);
  EXPECT_NEAR(power_w, 0.25e-3, kNearly * 0.25e-3);
}

TEST_F(RadiometerModelTest, IsWrongByTheRatioOfResponsivitiesAtAnotherWavelength) {
  ASSERT_TRUE(meter.set_wavelength(nanometres(600.0)));

  // 0.25 A/W at 500 nm and 0.36 A/W at 600 nm: 0.3248 A/W at 568 nm.
  EXPECT_NEAR(sample().power_w, 0.25e-3 * 0.3248 / 0.36, 1e-9 * 0.25e-3);
}

TEST_F(RadiometerModelTest, RefusesWavelengthsRangesAndCountsThatItDoesNotHave) {
  EXPECT_FALSE(meter.set_wavelength(nanometres(399.0)));
  EXPECT_FALSE(meter.set_wavelength(nanometres(1101.0)));
  EXPECT_FALSE(meter.set_range(0.02, bench.now));
  EXPECT_FALSE(meter.set_averages(0));
  EXPECT_EQ(in_nanometres(meter.wavelength()), in_nanometres(nanometres(568.0)));
  EXPECT_EQ(meter.full_scale_w(), 1e-3);
}

TEST_F(RadiometerModelTest, OverloadsAboveItsRange) {
  ASSERT_TRUE(meter.set_range(1e-4, bench.now));

  EXPECT_TRUE(sample().is_overload);
}

TEST_F(RadiometerModelTest, FindsTheRangeByItselfWhenItMay) {
  ASSERT_TRUE(meter.set_range(1e-6, bench.now));
  meter.set_auto_range(true);

  const RadiometerSample taken = sample();

  EXPECT_FALSE(taken.is_overload);
  EXPECT_NEAR(taken.power_w, 0.25e-3, kNearly * 0.25e-3);
  EXPECT_EQ(meter.full_scale_w(), 1e-3);
}

TEST_F(RadiometerModelTest, TakesItsTimeForEachAverage) {
  ASSERT_TRUE(meter.set_averages(50));
  const Instant before = bench.now;

  static_cast<void>(sample());

  EXPECT_NEAR(in_seconds(bench.now - before), 50 * 0.003, 1e-6);
}

class MonitorModelTest : public RadiometerModelTest {
 protected:
  static RadiometerSpec monitor() {
    RadiometerSpec spec = quiet_radiometer();
    spec.place = RadiometerPlace::Monitor;
    return spec;
  }
  MonitorModelTest() : RadiometerModelTest(monitor()) {}
};

TEST_F(MonitorModelTest, SeesTheLampWhateverTheShuttersDo) {
  bench.write(Field::SourceShutterCommand, 0);

  EXPECT_NEAR(sample().power_w, 1e-3, kNearly * 1e-3);
}

class NoisyModelTest : public RadiometerModelTest {
 protected:
  static RadiometerSpec noisy() {
    RadiometerSpec spec = quiet_radiometer();
    for (RadiometerRange& range : spec.ranges) {
      range.noise = 1e-3;
      range.offset = 0.01;
    }
    return spec;
  }
  NoisyModelTest() : RadiometerModelTest(noisy()) {}
  double noise_of(int averages, double range_w) {
    EXPECT_TRUE(meter.set_range(range_w, bench.now));
    EXPECT_TRUE(meter.set_averages(averages));
    constexpr int kSamples = 400;
    double sum2 = 0.0;
    for (int k = 0; k < kSamples; ++k) sum2 += std::pow(sample().power_w - 0.25e-3 - 0.01 * range_w, 2);
    return std::sqrt(sum2 / kSamples);
  }
};

// Five standard errors of a standard deviation of 400 samples: 18 %.
TEST_F(NoisyModelTest, HasTheNoiseOfItsRangeOverTheRootOfItsAverages) {
  SCOPED_TRACE(bench.instrument.scene().seed);

  EXPECT_NEAR(noise_of(1, 1e-3), 1e-6, 0.18e-6);
  EXPECT_NEAR(noise_of(16, 1e-3), 0.25e-6, 0.18 * 0.25e-6);
  EXPECT_NEAR(noise_of(1, 1e-2), 1e-5, 0.18e-5);
}

TEST_F(NoisyModelTest, LosesItsOffsetByAZeroInTheDark) {
  bench.write(Field::DetectorShutterCommand, 0);
  ASSERT_TRUE(zero());
  bench.write(Field::DetectorShutterCommand, 1);
  ASSERT_TRUE(meter.set_averages(100));

  EXPECT_NEAR(sample().power_w, 0.25e-3, 5.0 * 1.4e-7) << "offset was 1e-5; noise of sample and zero 1.3e-7";
}

TEST_F(NoisyModelTest, RefusesAZeroInTheLight) {
  EXPECT_FALSE(zero());
}

TEST_F(NoisyModelTest, TakesStrayLightForZeroAsARealOneDoes) {
  ASSERT_TRUE(meter.set_range(1e-2, bench.now));
  ASSERT_TRUE(zero()) << "0.25 mW is little in the range of 10 mW";
  ASSERT_TRUE(meter.set_averages(100));

  EXPECT_NEAR(sample().power_w, 0.0, 5.0 * 1.4e-6);
}

class SettlingModelTest : public RadiometerModelTest {
 protected:
  static RadiometerSpec settling() {
    RadiometerSpec spec = quiet_radiometer();
    spec.settle_s = 0.1;
    return spec;
  }
  SettlingModelTest() : RadiometerModelTest(settling()) {}
};

TEST_F(SettlingModelTest, IsOffAfterAChangeOfRangeAndComesBack) {
  ASSERT_TRUE(meter.set_range(1e-2, bench.now));

  EXPECT_NEAR(sample().power_w, 0.25e-3 + 0.05 * 1e-2, 1e-9);
  bench.wait(0.1 - 0.003);
  EXPECT_NEAR(sample().power_w, 0.25e-3 + 0.05 * 1e-2 * std::exp(-1.0), 1e-9);
  bench.wait(3.0);
  EXPECT_NEAR(sample().power_w, 0.25e-3, 1e-12);
}

}  // namespace
}  // namespace gonio::sim::test
