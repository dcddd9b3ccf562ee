#include "sim/devices/radiometer_face.h"

#include <gtest/gtest.h>

#include "tests/sim/bench.h"

namespace gonio::sim::test {
namespace {

class RadiometerFaceTest : public testing::Test {
 protected:
  static RadiometerSpec monitor() {
    RadiometerSpec spec = quiet_radiometer();
    spec.place = RadiometerPlace::Monitor;
    spec.zero_s = 0.5;
    return spec;
  }
  std::string say(std::string_view message) {
    face.execute(message, bench.now);
    for (int k = 0; k < 10 && face.output().empty() && face.due(); ++k) {
      bench.now = *face.due();
      face.advance_to(bench.now);
    }
    return face.take_output(1000);
  }

  Bench bench;
  RadiometerModel model{bench.instrument, monitor()};
  RadiometerFace face{model};
};

TEST_F(RadiometerFaceTest, SaysWhoItIs) {
  EXPECT_EQ(say("*IDN?\n"), "Goniod,Simulated power meter,SIM-PM-01,1.0\n");
}

TEST_F(RadiometerFaceTest, MeasuresWhenItIsAskedTo) {
  EXPECT_EQ(say("SENS:CORR:WAV 568;:READ?\n"), "1.000000000E-03\n");
}

TEST_F(RadiometerFaceTest, GoesOnInTheSamePathAndAnswersAllOfAMessageInOneLine) {
  EXPECT_EQ(say("SENSe:CORRection:WAVelength 500;WAV?;*OPC?;WAV 600;WAV?;:SENS:AVER 7;AVER?\n"),
            "5.000000E+02;1;6.000000E+02;7\n");
}

TEST_F(RadiometerFaceTest, SaysNothingUntilTheWholeMessageIsDone) {
  face.execute("*OPC?;READ?;*OPC?\n", bench.now);
  EXPECT_TRUE(face.output().empty());

  bench.now = face.due().value();
  face.advance_to(bench.now);

  EXPECT_EQ(face.output(), "1;8.334616372E-04;1\n") << "568 nm read as 633 nm: 1 mW x 0.3248 / 0.3897";
}

TEST_F(RadiometerFaceTest, QueuesItsErrorsAndShowsThemInTheStatusByte) {
  EXPECT_EQ(face.status_byte(), 0x00);

  EXPECT_EQ(say("NONSENSE 5;*CLX"), "");
  EXPECT_EQ(face.status_byte(), 0x04);
  EXPECT_EQ(say("SYST:ERR?"), "-113,\"Undefined header\"\n");
  EXPECT_EQ(say("SYST:ERR?"), "-113,\"Undefined header\"\n");
  EXPECT_EQ(say("SYST:ERR?"), "+0,\"No error\"\n");
  EXPECT_EQ(face.status_byte(), 0x00);
}

struct Refused {
  const char* message;
  const char* entry;
};

TEST_F(RadiometerFaceTest, NamesWhatItRefuses) {
  for (const Refused& r :
       {Refused{"SENS:CORR:WAV 5000", "-222"}, Refused{"SENS:CORR:WAV", "-109"}, Refused{"SENS:CORR:WAV blue", "-120"},
        Refused{"SENS:AVER:COUN 2.5", "-222"}, Refused{"SENS:POW:RANG -1", "-222"}, Refused{"SENS:POW:RANG 5", "-222"},
        Refused{"SENS:POW:UNIT LUMEN", "-224"}, Refused{"SENS:POW:RANG:AUTO 7", "-120"}, Refused{"READ? 5", "-108"},
        Refused{"SENS:CORR:WAV 568;;*CLS", "-102"}, Refused{"SENS:CORR:WAV 9.91E37", "-222"}}) {
    SCOPED_TRACE(r.message);
    EXPECT_EQ(say(r.message), "");

    EXPECT_TRUE(say("SYST:ERR?").starts_with(r.entry));
    EXPECT_EQ(say("SYST:ERR?"), "+0,\"No error\"\n");
  }
}

TEST_F(RadiometerFaceTest, BoundsItsErrorQueue) {
  for (int k = 0; k < 40; ++k) static_cast<void>(say("NONSENSE"));

  for (int k = 0; k < 15; ++k) EXPECT_TRUE(say("SYST:ERR?").starts_with("-113"));
  EXPECT_EQ(say("SYST:ERR?"), "-350,\"Queue overflow\"\n");
  EXPECT_EQ(say("SYST:ERR?"), "+0,\"No error\"\n");
}

TEST_F(RadiometerFaceTest, LosesAReplyThatNobodyFetchedAndSaysSo) {
  face.execute("*IDN?", bench.now);
  EXPECT_EQ(face.status_byte(), 0x10);

  EXPECT_EQ(say("*OPC?"), "1\n");
  EXPECT_EQ(say("SYST:ERR?"), "-410,\"Query INTERRUPTED\"\n");
}

TEST_F(RadiometerFaceTest, AnswersOpcOnceTheZeroIsDone) {
  const Instant before = bench.now;

  EXPECT_EQ(say("SENS:POW:RANG 1E-3;:SENS:CORR:COLL:ZERO;*OPC?"), "1\n");

  EXPECT_NEAR(in_seconds(bench.now - before), 0.5, 1e-6);
  EXPECT_EQ(say("SYST:ERR?"), "-340,\"Calibration failed\"\n") << "the lamp is on";
}

TEST_F(RadiometerFaceTest, ShowsDbmToWhoeverAskedForIt) {
  EXPECT_EQ(say("SENS:CORR:WAV 568;:SENS:POW:UNIT DBM;UNIT?;:READ?"), "DBM;0.000000000E+00\n");
}

TEST_F(RadiometerFaceTest, KeepsItsSettingsThroughADeviceClearAndLosesThemWithItsPower) {
  static_cast<void>(say("SENS:CORR:WAV 500"));
  face.execute("READ?", bench.now);

  face.clear();
  EXPECT_FALSE(face.due());
  EXPECT_EQ(say("SENS:CORR:WAV?"), "5.000000E+02\n");

  face.power_up();
  EXPECT_EQ(say("SENS:CORR:WAV?"), "6.330000E+02\n");
}

}  // namespace
}  // namespace gonio::sim::test
