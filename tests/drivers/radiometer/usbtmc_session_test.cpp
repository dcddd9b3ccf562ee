#include "drivers/links/usbtmc_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/drivers/radiometer/scripted_meter.h"

namespace gonio::drivers::test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

class UsbtmcSessionTest : public testing::Test {
 protected:
  void SetUp() override {
    meter.kept["WORD"] = "hello";
    const auto who = session.open();
    ASSERT_TRUE(who) << describe(who.error());
  }
  void expect_back_in_step() {
    const auto again = session.query("WORD?", 100ms);
    ASSERT_TRUE(again) << describe(again.error());
    EXPECT_EQ(*again, "hello");
  }

  ManualClock clock;
  ScriptedMeter meter{clock};
  UsbtmcSession session{meter, {.role = "monitor"}, clock};
};

TEST_F(UsbtmcSessionTest, EmptiesTheDeviceWhenItOpens) {
  EXPECT_EQ(meter.clears, 1);
  EXPECT_THAT(meter.halts_cleared, ElementsAre(0x01, 0x82));
}

TEST_F(UsbtmcSessionTest, AsksAndGetsTheReplyWithoutItsLineEnd) {
  expect_back_in_step();

  EXPECT_THAT(meter.heard, ElementsAre("WORD?"));
}

TEST_F(UsbtmcSessionTest, PutsAReplyTogetherThatComesInParts) {
  meter.bytes_in_a_transfer = 2;

  expect_back_in_step();
}

TEST_F(UsbtmcSessionTest, KeepsARequestOpenWhileTheReplyMayStillCome) {
  meter.samples = {"1.5"};
  meter.sample_time = 300ms;
  ASSERT_TRUE(session.ask("READ?", 1s));

  const auto early = session.poll(100ms);
  const auto late = session.poll(250ms);

  ASSERT_TRUE(early && late);
  EXPECT_FALSE(*early);
  EXPECT_EQ(*late, "1.5");
  EXPECT_EQ(meter.clears, 1) << "nothing went wrong";
}

TEST_F(UsbtmcSessionTest, ClearsWhenNoReplyComesInItsTime) {
  meter.fault = Fault::Silence;

  const auto reply = session.query("WORD?", 200ms);

  ASSERT_FALSE(reply);
  EXPECT_EQ(describe(reply.error()), "monitor: ask \"WORD?\": no reply; limit: 200 ms [timed-out]");
  EXPECT_EQ(reply.error().code, ErrorCode::TimedOut);
  EXPECT_EQ(meter.aborts, 1);
  EXPECT_EQ(meter.clears, 2);
  expect_back_in_step();
}

struct Case {
  Fault fault;
  ErrorCode code;
};

TEST_F(UsbtmcSessionTest, ComesBackIntoStepAfterEveryDamagedReply) {
  for (const Case& c : {Case{Fault::Stall, ErrorCode::DeviceRefused}, Case{Fault::Torn, ErrorCode::IncompleteData},
                        Case{Fault::StaleTag, ErrorCode::StaleData}, Case{Fault::WrongInverse, ErrorCode::BadReply},
                        Case{Fault::StallsCommand, ErrorCode::DeviceRefused}}) {
    SCOPED_TRACE(static_cast<int>(c.fault));
    const int clears = meter.clears;
    meter.fault = c.fault;

    const auto reply = session.query("WORD?", 200ms);

    ASSERT_FALSE(reply);
    EXPECT_EQ(reply.error().code, c.code);
    EXPECT_THAT(describe(reply.error()), HasSubstr("monitor: "));
    EXPECT_EQ(meter.clears, clears + 1);
    expect_back_in_step();
  }
}

TEST_F(UsbtmcSessionTest, WaitsForAClearThatTakesItsTime) {
  meter.clears_slowly = true;

  session.recover();

  EXPECT_TRUE(session.is_open());
  expect_back_in_step();
}

TEST_F(UsbtmcSessionTest, ClosesADeviceThatCannotBeEmptied) {
  meter.fault = Fault::Stall;
  meter.refuses_to_clear = true;

  EXPECT_FALSE(session.query("WORD?", 200ms));

  EXPECT_FALSE(session.is_open());
  EXPECT_EQ(session.open().error().code, ErrorCode::DeviceRefused);
  EXPECT_FALSE(session.is_open());
}

TEST_F(UsbtmcSessionTest, ClosesADeviceThatIsGone) {
  meter.is_gone = true;

  EXPECT_EQ(session.query("WORD?", 200ms).error().code, ErrorCode::Unreachable);

  EXPECT_FALSE(session.is_open());
  EXPECT_EQ(meter.clears, 1) << "nobody is there to be cleared";
}

TEST_F(UsbtmcSessionTest, DropsAReplyThatIsNoLongerWanted) {
  ASSERT_TRUE(session.ask("WORD?", 1s));
  meter.kept["OTHER"] = "bye";

  const auto reply = session.query("OTHER?", 100ms);

  ASSERT_TRUE(reply) << describe(reply.error());
  EXPECT_EQ(*reply, "bye");
}

TEST_F(UsbtmcSessionTest, RefusesToFetchWhatNobodyAskedFor) {
  EXPECT_EQ(session.poll(0ms).error().code, ErrorCode::WrongState);
}

TEST_F(UsbtmcSessionTest, RefusesAReplyWithoutEnd) {
  meter.kept["LONG"] = std::string(200, 'x');
  UsbtmcSession small(meter, {.role = "monitor", .most_reply_bytes = 100}, clock);
  meter.bytes_in_a_transfer = 60;

  const auto reply = small.query("LONG?", 100ms);

  ASSERT_FALSE(reply);
  EXPECT_EQ(reply.error().code, ErrorCode::BadReply);
}

TEST_F(UsbtmcSessionTest, ReadsTheStatusByteFromTheControlAnswer) {
  meter.errors = {"-113,\"Undefined header\""};

  EXPECT_EQ(session.status_byte().value(), 0x04);
}

TEST_F(UsbtmcSessionTest, ReadsTheStatusByteFromTheInterruptEndpointBehindServiceRequests) {
  meter.has_interrupt_in = true;
  meter.errors = {"-113,\"Undefined header\""};

  EXPECT_EQ(session.status_byte().value(), 0x04);
  meter.errors.clear();
  EXPECT_EQ(session.status_byte().value(), 0x00);
}

}  // namespace
}  // namespace gonio::drivers::test
