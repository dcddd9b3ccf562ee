// The device side by itself: bytes written from USB 2.0 (chapter 9), USBTMC 1.0 and USB488 1.0.
#include "sim/wires/usbtmc_function.h"

#include <gtest/gtest.h>

#include "tests/sim/bench.h"

namespace gonio::sim::test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using SetupBytes = std::array<std::uint8_t, 8>;

class UsbtmcFunctionTest : public testing::Test {
 protected:
  Bytes control(const SetupBytes& setup) {
    const UsbAnswer answer = function.control(setup, bench.now);
    EXPECT_EQ(answer.outcome, UsbOutcome::Done);
    return answer.bytes;
  }
  UsbOutcome send(const Bytes& bytes) { return function.bulk_out(bytes, bench.now); }
  // "*OPC?" under tag 1, then a request for 64 bytes under tag 2.
  void ask() {
    EXPECT_EQ(send({1, 1, 0xFE, 0, 6, 0, 0, 0, 1, 0, 0, 0, '*', 'O', 'P', 'C', '?', '\n', 0, 0}), UsbOutcome::Done);
    EXPECT_EQ(send(kRequest), UsbOutcome::Done);
  }
  const Bytes kRequest{2, 2, 0xFD, 0, 64, 0, 0, 0, 0, 0, 0, 0};
  const Bytes kReply{2, 2, 0xFD, 0, 2, 0, 0, 0, 1, 0, 0, 0, '1', '\n'};

  Bench bench;
  RadiometerModel model{bench.instrument, quiet_radiometer()};
  RadiometerFace face{model};
  UsbtmcFunction function{face, "SN-7"};
};

TEST_F(UsbtmcFunctionTest, DescribesADeviceWithOneUsb488Interface) {
  const Bytes bytes = function.descriptors();

  ASSERT_EQ(bytes.size(), 18U + 39U);
  EXPECT_EQ((Bytes{bytes.begin() + 8, bytes.begin() + 12}), (Bytes{0x09, 0x12, 0x01, 0x00}));
  EXPECT_EQ(bytes[18 + 2], 39) << "total length of the configuration";
  EXPECT_EQ((Bytes{bytes.begin() + 27, bytes.begin() + 36}), (Bytes{9, 4, 0, 0, 3, 0xFE, 3, 1, 0}));
  EXPECT_EQ(UsbtmcFunction(face, "SN-7", false).descriptors().size(), 18U + 32U);
}

TEST_F(UsbtmcFunctionTest, SaysItsSerialNumberAsAStringDescriptor) {
  EXPECT_EQ(control({0x80, 6, 3, 3, 9, 4, 255, 0}), (Bytes{10, 3, 'S', 0, 'N', 0, '-', 0, '7', 0}));
  EXPECT_EQ(control({0x80, 6, 3, 3, 9, 4, 4, 0}), (Bytes{10, 3, 'S', 0})) << "no more than asked for";
}

TEST_F(UsbtmcFunctionTest, AnswersAQueryUnderTheTagOfItsRequest) {
  ask();

  EXPECT_EQ(function.bulk_in(512, bench.now).bytes, kReply);
  EXPECT_EQ(function.bulk_in(512, bench.now).outcome, UsbOutcome::NotReady);
}

TEST_F(UsbtmcFunctionTest, SendsNoMoreThanAskedForAndTheRestLater) {
  EXPECT_EQ(send({1, 1, 0xFE, 0, 6, 0, 0, 0, 1, 0, 0, 0, '*', 'O', 'P', 'C', '?', '\n', 0, 0}), UsbOutcome::Done);
  EXPECT_EQ(send({2, 2, 0xFD, 0, 1, 0, 0, 0, 0, 0, 0, 0}), UsbOutcome::Done);

  EXPECT_EQ(function.bulk_in(512, bench.now).bytes, (Bytes{2, 2, 0xFD, 0, 1, 0, 0, 0, 0, 0, 0, 0, '1'}));
  EXPECT_EQ(send({2, 3, 0xFC, 0, 64, 0, 0, 0, 0, 0, 0, 0}), UsbOutcome::Done);
  EXPECT_EQ(function.bulk_in(512, bench.now).bytes, (Bytes{2, 3, 0xFC, 0, 1, 0, 0, 0, 1, 0, 0, 0, '\n'}));
}

TEST_F(UsbtmcFunctionTest, HaltsAnEndpointThatGetsWhatIsNoMessage) {
  EXPECT_EQ(send({9, 9, 9}), UsbOutcome::Stalled);
  EXPECT_EQ(send(kRequest), UsbOutcome::Stalled);

  function.clear_halt(UsbtmcFunction::kBulkOut);

  EXPECT_EQ(send(kRequest), UsbOutcome::Done);
  EXPECT_EQ(send(kRequest), UsbOutcome::Stalled) << "a second request before the first is answered";
}

TEST_F(UsbtmcFunctionTest, ForgetsEverythingAtAClear) {
  ask();

  EXPECT_EQ(control({0xA1, 5, 0, 0, 0, 0, 1, 0}), (Bytes{1}));
  EXPECT_EQ(control({0xA1, 6, 0, 0, 0, 0, 2, 0}), (Bytes{1, 0}));

  EXPECT_EQ(function.bulk_in(512, bench.now).outcome, UsbOutcome::NotReady);
  ask();
  EXPECT_EQ(function.bulk_in(512, bench.now).bytes, kReply);
}

TEST_F(UsbtmcFunctionTest, EndsATransferThatIsAbortedWithAnEmptyPacket) {
  EXPECT_EQ(control({0xA2, 3, 2, 0, 0x82, 0, 2, 0}), (Bytes{0x81, 2})) << "none is under way";
  EXPECT_EQ(send(kRequest), UsbOutcome::Done);

  EXPECT_EQ(control({0xA2, 3, 2, 0, 0x82, 0, 2, 0}), (Bytes{1, 2}));

  const UsbAnswer end = function.bulk_in(512, bench.now);
  EXPECT_EQ(end.outcome, UsbOutcome::Done);
  EXPECT_TRUE(end.bytes.empty());
  EXPECT_EQ(control({0xA2, 4, 0, 0, 0x82, 0, 8, 0}), (Bytes{1, 0, 0, 0, 0, 0, 0, 0}));
}

TEST_F(UsbtmcFunctionTest, SaysItsStatusByteOnTheInterruptEndpoint) {
  EXPECT_EQ(send({1, 1, 0xFE, 0, 3, 0, 0, 0, 1, 0, 0, 0, 'X', 'Y', '\n', 0}), UsbOutcome::Done);

  EXPECT_EQ(control({0xA1, 128, 5, 0, 0, 0, 3, 0}), (Bytes{1, 5, 0}));
  EXPECT_EQ(function.interrupt_in().bytes, (Bytes{0x85, 0x04}));
  EXPECT_EQ(function.interrupt_in().outcome, UsbOutcome::NotReady);
}

TEST_F(UsbtmcFunctionTest, SaysItsStatusByteInTheControlAnswerWithoutThatEndpoint) {
  UsbtmcFunction plain(face, "SN-7", false);

  EXPECT_EQ(plain.control(SetupBytes{0xA1, 128, 5, 0, 0, 0, 3, 0}, bench.now).bytes, (Bytes{1, 5, 0}));
}

TEST_F(UsbtmcFunctionTest, StallsRequestsThatItDoesNotKnow) {
  for (const SetupBytes& setup : {SetupBytes{0xC0, 0x55, 0, 0, 0, 0, 4, 0}, SetupBytes{0xA1, 99, 0, 0, 0, 0, 4, 0},
                                  SetupBytes{0x80, 6, 9, 3, 0, 0, 4, 0}}) {
    EXPECT_EQ(function.control(setup, bench.now).outcome, UsbOutcome::Stalled);
  }
}

TEST_F(UsbtmcFunctionTest, HasTheFaultsThatAreMeantForItAtTheReplyThatTheyWaitFor) {
  PlannedFault torn{.kind = FaultKind::RadiometerReplyTorn, .after = 1};
  PlannedFault of_the_monitor{.kind = FaultKind::RadiometerReplyTorn};
  of_the_monitor.values[FaultParameter::Role] = static_cast<double>(FaultRole::Monitor);
  ASSERT_TRUE(bench.instrument.arm(torn, bench.now));
  ASSERT_TRUE(bench.instrument.arm(of_the_monitor, bench.now));

  ask();
  EXPECT_EQ(function.bulk_in(512, bench.now).bytes, kReply);
  ask();
  EXPECT_EQ(function.bulk_in(512, bench.now).bytes, (Bytes{kReply.begin(), kReply.begin() + 13}));
  ask();
  EXPECT_EQ(function.bulk_in(512, bench.now).bytes, kReply);
  EXPECT_EQ(bench.instrument.faults().count(FaultKind::RadiometerReplyTorn, bench.now).fired, 1U);
}

TEST_F(UsbtmcFunctionTest, SaysNothingOnceItsCableIsOut) {
  ask();
  EXPECT_FALSE(function.is_unplugged(bench.now));

  ASSERT_TRUE(bench.instrument.arm({.kind = FaultKind::RadiometerUnplugged, .after = 0}, bench.now));

  EXPECT_EQ(function.bulk_in(512, bench.now).outcome, UsbOutcome::NotReady);
  EXPECT_TRUE(function.is_unplugged(bench.now));
  bench.instrument.end_fault(FaultKind::RadiometerUnplugged, bench.now);
  EXPECT_FALSE(function.is_unplugged(bench.now));
}

}  // namespace
}  // namespace gonio::sim::test
