// The whole driver on the simulated radiometer, in one process and in manual time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/radiometer/scpi_radiometer.h"
#include "tests/sim/bench.h"
#include "tests/support/in_process_usbtmc_link.h"

namespace gonio::sim::test {
namespace {

using namespace std::chrono_literals;
using drivers::RadiometerReading;
using Collected = Result<std::optional<RadiometerReading>>;

class RadiometerDriverTest : public testing::Test {
 protected:
  static RadiometerSpec monitor() {
    RadiometerSpec spec = quiet_radiometer();
    spec.place = RadiometerPlace::Monitor;
    return spec;
  }
  static drivers::ScpiRadiometerConfig config() {
    return {.role = "monitor",
            .serial = "SIM-PM-01",
            .settings = {.wavelength = nanometres(568.0), .range_w = 1e-2, .averages = 2, .samples = 5},
            .range_settle = 20ms};
  }
  // Lets the time pass in which the meter works.
  Collected finish() {
    for (int k = 0; k < 1000; ++k) {
      auto taken = driver.collect(0ms);
      if (!taken || *taken) return taken;
      const auto due = meter.with([](const UsbtmcFunction& function, Instant) { return function.due(); });
      clock.advance_to(due.value_or(clock.now() + 1s));
    }
    return std::optional<RadiometerReading>();
  }
  Collected take() {
    if (auto triggered = driver.trigger(); !triggered) return failure(triggered.error());
    return finish();
  }
  void expect_right_reading() {
    const Collected taken = take();
    ASSERT_TRUE(taken) << describe(taken.error());
    ASSERT_TRUE(*taken);
    EXPECT_NEAR((*taken)->mean_w, 1e-3, 1e-12);
    EXPECT_EQ((*taken)->samples, 5);
  }

  ManualClock clock;
  LiveInstrument instrument{quiet_scene(), {}, clock};
  LiveRadiometer meter{instrument, monitor()};
  gonio::test::InProcessUsbtmcLink link{meter};
  drivers::ScpiRadiometer driver{link, config(), clock};
};

TEST_F(RadiometerDriverTest, ReadsTheLamp) {
  expect_right_reading();
}

TEST_F(RadiometerDriverTest, ReadsTheLampOfAMeterThatSomebodyLeftInDbmAndInAnotherRange) {
  meter.with([](UsbtmcFunction& function, Instant now) {
    const std::string left = "SENS:POW:UNIT DBM;:SENS:POW:RANG 1E-6;:SENS:CORR:WAV 1000\n";
    EXPECT_EQ(
        function.bulk_out(usbtmc::dev_dep_msg_out(9, std::vector<std::uint8_t>(left.begin(), left.end()), true), now),
        UsbOutcome::Done);
  });

  expect_right_reading();
}

TEST_F(RadiometerDriverTest, ReadsTheLampOfAMeterThatWasLeftInMidSentence) {
  meter.with([](UsbtmcFunction& function, Instant now) {
    const std::string half = "*IDN?;SENS:CORR:WA";
    EXPECT_EQ(
        function.bulk_out(usbtmc::dev_dep_msg_out(9, std::vector<std::uint8_t>(half.begin(), half.end()), false), now),
        UsbOutcome::Done);
  });

  expect_right_reading();
}

struct Outcome {
  RadiometerFault fault;
  ErrorCode code;
};

TEST_F(RadiometerDriverTest, RefusesTheReadingOfEveryFaultAndIsRightAgain) {
  for (const Outcome& o : {Outcome{RadiometerFault::Stall, ErrorCode::DeviceRefused},
                           Outcome{RadiometerFault::Silence, ErrorCode::TimedOut},
                           Outcome{RadiometerFault::TornReply, ErrorCode::IncompleteData},
                           Outcome{RadiometerFault::DuplicatedReply, ErrorCode::StaleData},
                           Outcome{RadiometerFault::StaleTag, ErrorCode::StaleData},
                           Outcome{RadiometerFault::NotANumber, ErrorCode::BadReply},
                           Outcome{RadiometerFault::Overload, ErrorCode::Saturated}}) {
    SCOPED_TRACE(static_cast<int>(o.fault));
    ASSERT_TRUE(driver.trigger());
    meter.with([&](UsbtmcFunction& function, Instant) { function.inject(o.fault, 2); });

    const Collected taken = finish();

    ASSERT_FALSE(taken);
    EXPECT_EQ(taken.error().code, o.code) << describe(taken.error());
    EXPECT_EQ(taken.error().device, "monitor");
    expect_right_reading();
  }
}

TEST_F(RadiometerDriverTest, ReadsAgainWhenTheMeterHasBeenUnpluggedAndIsBack) {
  expect_right_reading();
  ASSERT_TRUE(driver.trigger());
  link.set_unplugged(true);
  EXPECT_EQ(finish().error().code, ErrorCode::Unreachable);
  EXPECT_EQ(driver.trigger().error().code, ErrorCode::Unreachable);

  link.set_unplugged(false);

  expect_right_reading();
}

TEST_F(RadiometerDriverTest, WaitsOutTheSettlingOfARange) {
  RadiometerSpec slow = monitor();
  slow.settle_s = 0.002;
  LiveRadiometer settling(instrument, slow);
  gonio::test::InProcessUsbtmcLink to_settling(settling);
  drivers::ScpiRadiometer other(to_settling, config(), clock);
  ASSERT_TRUE(other.ensure_open());
  ASSERT_TRUE(other.apply({.wavelength = nanometres(568.0), .range_w = 1e-3 * 10.0, .averages = 1, .samples = 5}));
  ASSERT_TRUE(other.trigger());

  Collected taken = other.collect(0ms);
  for (int k = 0; k < 1000 && taken && !*taken; ++k) {
    clock.advance(1ms);
    taken = other.collect(0ms);
  }

  ASSERT_TRUE(taken) << describe(taken.error());
  ASSERT_TRUE(*taken);
  EXPECT_NEAR((*taken)->mean_w, 1e-3, 0.05 * 1e-2 * 4.6e-5) << "exp(-20 ms / 2 ms) of 5 % of 10 mW is left";
}

// A bus asks what is due while time goes on: what ended between two looks must not be forgotten.
TEST_F(RadiometerDriverTest, StaysDueUntilTheSampleHasBeenTaken) {
  ASSERT_TRUE(driver.trigger());
  const auto due = [&] { return meter.with([](const UsbtmcFunction& function, Instant) { return function.due(); }); };
  const auto before = due();

  clock.advance(10s);

  EXPECT_EQ(due(), before);
  meter.with([](UsbtmcFunction& function, Instant now) { function.advance_to(now); });
  EXPECT_FALSE(due());
}

TEST_F(RadiometerDriverTest, HasTheStandardErrorThatItsSamplesHave) {
  RadiometerSpec noisy = monitor();
  for (RadiometerRange& range : noisy.ranges) range.noise = 1e-3;
  LiveRadiometer with_noise(instrument, noisy);
  gonio::test::InProcessUsbtmcLink to_noise(with_noise);
  drivers::ScpiRadiometerConfig many = config();
  many.settings.averages = 1;
  many.settings.samples = 400;
  drivers::ScpiRadiometer other(to_noise, many, clock);
  ASSERT_TRUE(other.trigger());

  Collected taken = other.collect(0ms);
  for (int k = 0; k < 2000 && taken && !*taken; ++k) {
    clock.advance(3ms);
    taken = other.collect(0ms);
  }

  ASSERT_TRUE(taken && *taken);
  // 1e-5 W over the root of 400; five standard errors of each.
  EXPECT_NEAR((*taken)->standard_error_w, 5e-7, 0.18 * 5e-7);
  EXPECT_NEAR((*taken)->mean_w, 1e-3, 5.0 * 5e-7);
}

TEST_F(RadiometerDriverTest, TellsThatALitMeterCannotZero) {
  ASSERT_TRUE(driver.start_zero());
  EXPECT_FALSE(*driver.is_zeroed(0ms));
  clock.advance(500ms);

  const auto zeroed = driver.is_zeroed(0ms);

  ASSERT_TRUE(zeroed) << describe(zeroed.error()) << ": 1 mW is a tenth of 10 mW, and still taken";
  ASSERT_TRUE(driver.apply({.wavelength = nanometres(568.0), .range_w = 1e-3, .averages = 1, .samples = 5}));
  ASSERT_TRUE(driver.start_zero());
  clock.advance(500ms);
  EXPECT_EQ(driver.is_zeroed(0ms).error().code, ErrorCode::DeviceRefused);
}

}  // namespace
}  // namespace gonio::sim::test
