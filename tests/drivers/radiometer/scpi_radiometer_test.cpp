#include "drivers/radiometer/scpi_radiometer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/drivers/radiometer/scripted_meter.h"

namespace gonio::drivers::test {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::HasSubstr;
using Collected = Result<std::optional<RadiometerReading>>;

class ScpiRadiometerTest : public testing::Test {
 protected:
  ScpiRadiometerTest() {
    meter.answers["*IDN?"] = "Maker,PM-1,RAD-1,1.0";
    meter.answers["CONF?"] = "\"POW\"";
    meter.answers["*OPC?"] = "1";
    meter.samples = {"1.0E-3"};
    meter.sample_time = 10ms;
  }
  static ScpiRadiometerConfig config() {
    return {.role = "monitor",
            .serial = "RAD-1",
            .settings = {.wavelength = nanometres(568.0), .range_w = 0.01, .averages = 3, .samples = 4},
            .sample_time = 10ms,
            .range_settle = Duration::zero()};
  }
  Collected take(ScpiRadiometer& from) {
    if (auto triggered = from.trigger(); !triggered) return failure(triggered.error());
    return from.collect(10s);
  }
  Collected take() { return take(radiometer); }
  void expect_failure(const Collected& taken, ErrorCode code, const std::string& words) {
    ASSERT_FALSE(taken.has_value());
    EXPECT_EQ(taken.error().code, code);
    EXPECT_EQ(taken.error().device, "monitor");
    EXPECT_THAT(describe(taken.error()), HasSubstr(words));
  }
  void expect_well_again() {
    meter.samples = {"2.0E-3"};
    const auto taken = take();
    ASSERT_TRUE(taken) << describe(taken.error());
    ASSERT_TRUE(*taken);
    EXPECT_EQ((*taken)->mean_w, 2.0e-3);
  }

  ManualClock clock;
  ScriptedMeter meter{clock};
  ScpiRadiometer radiometer{meter, config(), clock};
};

TEST_F(ScpiRadiometerTest, WritesItsSettingsWhenItOpensAndReadsThemBack) {
  const auto who = radiometer.ensure_open();

  ASSERT_TRUE(who) << describe(who.error());
  EXPECT_EQ(who->vendor, "Maker");
  EXPECT_EQ(who->model, "PM-1");
  EXPECT_EQ(meter.kept["SENS:CORR:WAV"], "568");
  EXPECT_EQ(meter.kept["SENS:AVER:COUN"], "3");
  EXPECT_EQ(meter.kept["SENS:POW:RANG:AUTO"], "0");
  EXPECT_EQ(meter.kept["SENS:POW:RANG"], "0.01");
  EXPECT_EQ(meter.kept["SENS:POW:UNIT"], "W");
  for (const char* query : {"SENS:CORR:WAV?", "SENS:AVER:COUN?", "SENS:POW:RANG?", "SENS:POW:UNIT?", "CONF?"}) {
    EXPECT_THAT(meter.heard, Contains(query));
  }
}

TEST_F(ScpiRadiometerTest, OpensOnce) {
  ASSERT_TRUE(radiometer.ensure_open());
  ASSERT_TRUE(radiometer.ensure_open());

  EXPECT_EQ(meter.opens, 1);
}

TEST_F(ScpiRadiometerTest, RefusesAMeterWithAnotherSerialNumberAndLetsItGo) {
  meter.answers["*IDN?"] = "Maker,PM-1,RAD-2,1.0";

  const auto who = radiometer.ensure_open();

  ASSERT_FALSE(who);
  EXPECT_EQ(describe(who.error()), "monitor: ask \"*IDN?\": serial RAD-2; limit: serial RAD-1 [wrong-device]");
  EXPECT_EQ(who.error().code, ErrorCode::WrongDevice);
  EXPECT_FALSE(meter.is_open());
}

TEST_F(ScpiRadiometerTest, SaysThatAMeterSaidNothing) {
  meter.answers["*IDN?"] = "";

  const auto who = radiometer.ensure_open();

  ASSERT_FALSE(who);
  EXPECT_EQ(who.error().seen, "\"\"");
  EXPECT_EQ(who.error().limit, "maker, model, serial number, version");
}

TEST_F(ScpiRadiometerTest, NamesTheSettingThatWasNotTaken) {
  meter.answers["SENS:POW:RANG?"] = "1.0E-1";

  const auto who = radiometer.ensure_open();

  ASSERT_FALSE(who);
  EXPECT_EQ(who.error().code, ErrorCode::SettingNotTaken);
  EXPECT_EQ(describe(who.error()), "monitor: set SENS:POW:RANG to 0.01 W: 0.1 W read back [setting-not-taken]");
}

TEST_F(ScpiRadiometerTest, TellsWhatTheMeterSaysOfARefusedSetting) {
  meter.refused["SENS:CORR:WAV 568"] = "-222,\"Data out of range\"";

  const auto who = radiometer.ensure_open();

  ASSERT_FALSE(who);
  EXPECT_EQ(who.error().code, ErrorCode::DeviceRefused);
  EXPECT_EQ(describe(who.error()), "monitor: send \"SENS:CORR:WAV 568\": -222 Data out of range [device-refused]");
  EXPECT_TRUE(meter.errors.empty()) << "the queue is left empty";
}

TEST_F(ScpiRadiometerTest, GivesTheMeanAndItsStandardError) {
  meter.samples = {"1.0E-3", "2.0E-3", "3.0E-3", "6.0E-3"};

  const auto taken = take();

  ASSERT_TRUE(taken) << describe(taken.error());
  ASSERT_TRUE(*taken);
  EXPECT_DOUBLE_EQ((*taken)->mean_w, 3.0e-3);
  EXPECT_NEAR((*taken)->standard_error_w, 1.0801234497346435e-3, 1e-17) << "sqrt(14 / 3 / 4) mW";
  EXPECT_EQ((*taken)->samples, 4);
  EXPECT_EQ((*taken)->range_w, 0.01);
}

TEST_F(ScpiRadiometerTest, ComesBackForAReadingThatIsNotThereYet) {
  ASSERT_TRUE(radiometer.trigger());

  int looks = 1;
  auto taken = radiometer.collect(4ms);
  while (taken && !*taken && looks < 100) {
    ++looks;
    taken = radiometer.collect(4ms);
  }

  ASSERT_TRUE(taken) << describe(taken.error());
  ASSERT_TRUE(*taken);
  EXPECT_GE(looks, 10) << "40 ms in looks of 4 ms";
  EXPECT_EQ(radiometer.collect(4ms).error().code, ErrorCode::WrongState) << "each reading is handed out once";
}

TEST_F(ScpiRadiometerTest, ThrowsAwaySamplesUntilTheRangeHasSettled) {
  ScpiRadiometerConfig slow = config();
  slow.range_settle = 25ms;
  ScpiRadiometer settling(meter, slow, clock);
  meter.samples = {"9.0", "8.0", "7.0", "1.0"};

  const auto taken = take(settling);

  ASSERT_TRUE(taken) << describe(taken.error());
  ASSERT_TRUE(*taken);
  EXPECT_EQ((*taken)->mean_w, 1.0) << "the three that began in the first 25 ms are gone";
  EXPECT_EQ((*taken)->standard_error_w, 0.0);
}

TEST_F(ScpiRadiometerTest, BeginsAnewWhenTheMeterChangesItsRange) {
  ASSERT_TRUE(radiometer.apply({.wavelength = nanometres(568.0), .averages = 3, .samples = 2}));
  meter.samples = {"5.0", "5.0", "1.0"};
  meter.kept["SENS:POW:RANG"] = "0.1";
  ASSERT_TRUE(radiometer.trigger());
  meter.kept["SENS:POW:RANG"] = "1";

  const auto taken = radiometer.collect(10s);

  ASSERT_TRUE(taken) << describe(taken.error());
  ASSERT_TRUE(*taken);
  EXPECT_EQ((*taken)->mean_w, 1.0);
  EXPECT_EQ((*taken)->range_w, 1.0);
}

TEST_F(ScpiRadiometerTest, NeverMakesAReadingOfAnOverload) {
  meter.samples = {"1.0E-3", "9.9E37"};

  expect_failure(take(), ErrorCode::Saturated, "overload");
  expect_well_again();
}

TEST_F(ScpiRadiometerTest, NeverMakesAReadingOfNotANumber) {
  meter.samples = {"1.0E-3", "9.91E37"};

  expect_failure(take(), ErrorCode::BadReply, "finite number");
  expect_well_again();
}

TEST_F(ScpiRadiometerTest, RefusesAReadingWithAnErrorOfTheMeter) {
  ASSERT_TRUE(radiometer.ensure_open());
  meter.refused["READ?"] = "-230,\"Data corrupt or stale\"";
  meter.errors = {"-350,\"Queue overflow\""};

  const auto triggered = radiometer.trigger();

  ASSERT_FALSE(triggered);
  EXPECT_THAT(describe(triggered.error()), HasSubstr("-350 Queue overflow"));
  expect_failure(take(), ErrorCode::DeviceRefused, "-230 Data corrupt or stale");
}

struct Case {
  Fault fault;
  ErrorCode code;
  const char* words;
};

TEST_F(ScpiRadiometerTest, RefusesEachDamagedReplyAndIsWellAgain) {
  for (const Case& c : {Case{Fault::Silence, ErrorCode::TimedOut, "no reply; limit: 530 ms"},
                        Case{Fault::Stall, ErrorCode::DeviceRefused, "ask \"READ?\""},
                        Case{Fault::Torn, ErrorCode::IncompleteData, "1 bytes of data"},
                        Case{Fault::StaleTag, ErrorCode::StaleData, "tag"},
                        Case{Fault::WrongInverse, ErrorCode::BadReply, "inverse"}}) {
    SCOPED_TRACE(static_cast<int>(c.fault));
    ASSERT_TRUE(radiometer.trigger());
    meter.fault = c.fault;

    expect_failure(radiometer.collect(10s), c.code, c.words);
    expect_well_again();
  }
}

TEST_F(ScpiRadiometerTest, RefusesAReplyThatIsFollowedByAnotherOne) {
  ASSERT_TRUE(radiometer.ensure_open());
  meter.fault = Fault::Twice;

  const auto triggered = radiometer.trigger();

  ASSERT_FALSE(triggered);
  EXPECT_EQ(triggered.error().code, ErrorCode::StaleData);
  EXPECT_THAT(describe(triggered.error()), HasSubstr("nobody asked for"));
  expect_well_again();
}

TEST_F(ScpiRadiometerTest, WritesItsSettingsAgainWhenTheMeterHasReturned) {
  ASSERT_TRUE(take());
  ASSERT_TRUE(radiometer.trigger());
  meter.is_gone = true;
  expect_failure(radiometer.collect(1s), ErrorCode::Unreachable, "READ?");
  EXPECT_EQ(radiometer.ensure_open().error().code, ErrorCode::Unreachable);

  meter.is_gone = false;
  meter.kept.clear();

  expect_well_again();
  EXPECT_EQ(meter.opens, 2);
  EXPECT_EQ(meter.kept["SENS:CORR:WAV"], "568");
}

TEST_F(ScpiRadiometerTest, ZeroesAndTellsWhenItIsDone) {
  ASSERT_TRUE(radiometer.start_zero());
  EXPECT_EQ(radiometer.trigger().error().code, ErrorCode::WrongState) << "a zero is under way";

  const auto done = radiometer.is_zeroed(1s);

  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_TRUE(*done);
  EXPECT_EQ(radiometer.is_zeroed(1s).error().code, ErrorCode::WrongState);
  expect_well_again();
}

TEST_F(ScpiRadiometerTest, TellsWhyTheMeterCouldNotZero) {
  meter.refused["*OPC?"] = "-340,\"Calibration failed\"";
  ASSERT_TRUE(radiometer.start_zero());

  const auto done = radiometer.is_zeroed(1s);

  ASSERT_FALSE(done);
  EXPECT_THAT(describe(done.error()), HasSubstr("-340 Calibration failed"));
}

TEST_F(ScpiRadiometerTest, RefusesSettingsThatMakeNoReading) {
  for (const RadiometerSettings& settings :
       {RadiometerSettings{.wavelength = nanometres(568.0), .samples = 1},
        RadiometerSettings{.wavelength = nanometres(568.0), .averages = 0},
        RadiometerSettings{.wavelength = nanometres(568.0), .range_w = 0.0}, RadiometerSettings{}}) {
    EXPECT_EQ(radiometer.apply(settings).error().code, ErrorCode::InvalidInput);
  }
  EXPECT_TRUE(meter.heard.empty());
}

TEST_F(ScpiRadiometerTest, WritesAllAgainAfterASettingThatFailed) {
  ASSERT_TRUE(radiometer.ensure_open());
  meter.refused["SENS:CORR:WAV 5000"] = "-222,\"Data out of range\"";

  EXPECT_FALSE(radiometer.apply({.wavelength = nanometres(5000.0), .range_w = 0.01}));

  ASSERT_TRUE(radiometer.ensure_open());
  EXPECT_EQ(meter.opens, 2);
  EXPECT_EQ(meter.kept["SENS:CORR:WAV"], "568");
}

}  // namespace
}  // namespace gonio::drivers::test
