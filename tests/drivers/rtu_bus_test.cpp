// PDUs are those of the examples in MODBUS Application Protocol V1.1b3; their CRCs were computed apart, by the
// procedure of Modbus over Serial Line V1.02, 6.2.2 (whose own example, 02 07, has 41 12).
#include "drivers/links/rtu_bus.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <future>

#include "drivers/modbus_stage/modbus_halt_line.h"
#include "drivers/modbus_stage/modbus_stage.h"
#include "tests/drivers/scripted_rtu_peer.h"
#include "tests/drivers/stage_states.h"

namespace gonio::drivers {
namespace {

using namespace std::chrono_literals;
using test::Bytes;
using test::bytes;
using test::ScriptedRtuPeer;
using test::with_crc;
using testing::HasSubstr;

constexpr Duration kPatience = 30s;  // of a reply that does come: never used up, however slow the machine
constexpr Duration kShort = 20ms;    // of one that does not

RtuLineConfig config(const std::string& device, Duration reply_timeout, std::uint8_t unit = 17) {
  return {.line = {.device = device, .parity = Parity::None, .stop_bits = 2},
          .unit_id = unit,
          .reply_timeout = reply_timeout,
          .pause = 5ms};
}

ScriptedRtuPeer::Script always(const std::string& frame) {
  return [frame](const Bytes&, std::size_t) { return bytes(frame); };
}

// `first` once, then `then`.
ScriptedRtuPeer::Script first_then(const std::string& first, const std::string& then) {
  return [=](const Bytes&, std::size_t index) { return bytes(index == 0 ? first : then); };
}

constexpr const char* kSeven = "11 03 02 00 07 38 45";

// 20 ms can be short on a busy machine.
Result<void> read_until_it_works(ModbusLink& link, std::array<std::uint16_t, 1>& word) {
  Result<void> done = link.read_registers(0, word);
  for (int i = 0; i < 1000 && !done; ++i) done = link.read_registers(0, word);
  return done;
}

TEST(RtuBus, ReadsHoldingRegistersAsTheStandardPrintsIt) {
  ScriptedRtuPeer peer(always("11 03 06 02 2b 00 00 00 64 c8 ba"));
  RtuBus bus(config(peer.device(), kPatience));
  std::array<std::uint16_t, 3> words{};

  const auto done = bus.normal().read_registers(0x006B, words);

  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_EQ(words, (std::array<std::uint16_t, 3>{0x022B, 0x0000, 0x0064}));
  peer.wait_for_requests(1);
  EXPECT_EQ(peer.requests().at(0), bytes("11 03 00 6b 00 03 76 87"));
}

TEST(RtuBus, SpeaksToSeveralUnitsByTheFunctionsOfEach) {
  ScriptedRtuPeer peer([](const Bytes& request, std::size_t) {
    if (request[0] == 5) return with_crc(bytes("05 04 02 00 0a"));
    return with_crc(bytes("06 10 00 01 00 01"));
  });
  RtuBus bus(config(peer.device(), kPatience));
  const auto five = bus.for_unit(RtuBus::Rank::Normal, {.unit_id = 5, .reads = stage::ReadFunction::Input});
  const auto six = bus.for_unit(RtuBus::Rank::Urgent, {.unit_id = 6, .writes = stage::WriteFunction::Multiple});
  std::array<std::uint16_t, 1> word{};

  const auto read = five->read_registers(8, word);
  const auto wrote = six->write_registers(1, std::array<std::uint16_t, 1>{3});

  ASSERT_TRUE(read) << describe(read.error());
  ASSERT_TRUE(wrote) << describe(wrote.error());
  EXPECT_EQ(word[0], 0x000A);
  EXPECT_EQ(peer.requests().at(0), with_crc(bytes("05 04 00 08 00 01")));
  EXPECT_EQ(peer.requests().at(1), with_crc(bytes("06 10 00 01 00 01 02 00 03")));
}

TEST(RtuBus, TakesNoUnitsReplyForAnothers) {
  ScriptedRtuPeer peer([](const Bytes&, std::size_t) { return with_crc(bytes("05 03 02 00 07")); });
  RtuBus bus(config(peer.device(), kShort));
  const auto six = bus.for_unit(RtuBus::Rank::Normal, {.unit_id = 6});
  std::array<std::uint16_t, 1> word{};

  const auto read = six->read_registers(0, word);

  ASSERT_FALSE(read.has_value());
  EXPECT_EQ(word[0], 0);
}

TEST(RtuBus, WritesOneRegisterAsTheStandardPrintsIt) {
  ScriptedRtuPeer peer(always("11 06 00 01 00 03 9a 9b"));
  RtuBus bus(config(peer.device(), kPatience));
  const std::array<std::uint16_t, 1> words{3};

  const auto done = bus.normal().write_registers(1, words);

  ASSERT_TRUE(done) << describe(done.error());
  peer.wait_for_requests(1);
  EXPECT_EQ(peer.requests().at(0), bytes("11 06 00 01 00 03 9a 9b"));
}

TEST(RtuBus, WritesSeveralRegistersAsTheStandardPrintsIt) {
  ScriptedRtuPeer peer(always("11 10 00 01 00 02 12 98"));
  RtuBus bus(config(peer.device(), kPatience));
  const std::array<std::uint16_t, 2> words{0x000A, 0x0102};

  const auto done = bus.normal().write_registers(1, words);

  ASSERT_TRUE(done) << describe(done.error());
  peer.wait_for_requests(1);
  EXPECT_EQ(peer.requests().at(0), bytes("11 10 00 01 00 02 04 00 0a 01 02 c6 f0"));
}

TEST(RtuBus, WritesAndReadsInOneTransactionAsTheStandardPrintsIt) {
  ScriptedRtuPeer peer(always("11 17 0c 00 fe 0a cd 00 01 00 03 00 0d 00 ff 0d 75"));
  RtuBus bus(config(peer.device(), kPatience));
  const std::array<std::uint16_t, 3> written{0x00FF, 0x00FF, 0x00FF};
  std::array<std::uint16_t, 6> words{};

  const auto done = bus.normal().write_and_read(14, written, 3, words);

  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_EQ(words, (std::array<std::uint16_t, 6>{0x00FE, 0x0ACD, 0x0001, 0x0003, 0x000D, 0x00FF}));
  peer.wait_for_requests(1);
  EXPECT_EQ(peer.requests().at(0), bytes("11 17 00 03 00 06 00 0e 00 03 06 00 ff 00 ff 00 ff 4b 54"));
}

TEST(RtuBus, StaysInStepAfterAnExceptionReply) {
  ScriptedRtuPeer peer(first_then("11 83 02 c1 34", kSeven));
  RtuBus bus(config(peer.device(), 1h));  // an hour of quiet would be due after any other error
  std::array<std::uint16_t, 1> word{};

  const auto refused = bus.normal().read_registers(0, word);
  const auto done = bus.normal().read_registers(1, word);

  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::DeviceRefused);
  EXPECT_THAT(refused.error().seen, HasSubstr("illegal data address"));
  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_EQ(word[0], 7);
}

TEST(RtuBus, TimesOutAndAsksAgain) {
  ScriptedRtuPeer peer(first_then("", kSeven));
  RtuBus bus(config(peer.device(), kShort));
  std::array<std::uint16_t, 1> word{};

  const auto lost = bus.normal().read_registers(0, word);
  const auto done = read_until_it_works(bus.normal(), word);

  ASSERT_FALSE(lost.has_value());
  EXPECT_EQ(lost.error().code, ErrorCode::TimedOut);
  EXPECT_THAT(describe(lost.error()), HasSubstr("read 1 registers from 0"));
  EXPECT_THAT(lost.error().limit, HasSubstr("20 ms"));
  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_EQ(word[0], 7);
}

struct Spoilt {
  const char* what;
  const char* frame;
  ErrorCode code;
};

class SpoiltReply : public testing::TestWithParam<Spoilt> {};

TEST_P(SpoiltReply, IsRefusedAndTheNextIsRight) {
  ScriptedRtuPeer peer(first_then(GetParam().frame, kSeven));
  RtuBus bus(config(peer.device(), 1s));
  std::array<std::uint16_t, 1> word{};

  const auto wrong = bus.normal().read_registers(0, word);
  const auto done = read_until_it_works(bus.normal(), word);

  ASSERT_FALSE(wrong.has_value());
  EXPECT_EQ(wrong.error().code, GetParam().code) << describe(wrong.error());
  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_EQ(word[0], 7);
}

INSTANTIATE_TEST_SUITE_P(OnALine, SpoiltReply,
                         testing::Values(Spoilt{"WrongCrc", "11 03 02 00 08 38 45", ErrorCode::BadReply},
                                         Spoilt{"OtherUnit", "12 03 02 00 07 7c 45", ErrorCode::BadReply},
                                         Spoilt{"OtherFunction", "11 06 00 01 00 03 9a 9b", ErrorCode::BadReply},
                                         Spoilt{"OtherCount", "11 03 06 02 2b 00 00 00 64 c8 ba", ErrorCode::BadReply},
                                         Spoilt{"Torn", "11 03 02 00", ErrorCode::TimedOut}),
                         [](const auto& spoilt) { return std::string(spoilt.param.what); });

TEST(RtuBus, ThrowsAwayAReplyThatComesWhileNobodyWaits) {
  ScriptedRtuPeer peer(first_then("", kSeven));
  RtuBus bus(config(peer.device(), kShort));
  std::array<std::uint16_t, 1> word{};
  ASSERT_FALSE(bus.normal().read_registers(0, word));

  peer.say(with_crc(bytes("11 03 02 00 63")));  // 99, to the first request

  const auto done = read_until_it_works(bus.normal(), word);
  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_EQ(word[0], 7);
}

// A stage whose status says in `boot_counter` which request it answers. The reply to the first request comes when
// request number `lag` is asked, before the reply to that.
TEST(RtuBus, NeverTakesALateReplyForTheStateOfTheStage) {
  const StageConfig stage_config = test::simple_config();
  for (const std::size_t lag : {1U, 2U, 3U}) {
    SCOPED_TRACE("the first reply comes with reply " + std::to_string(lag));
    std::atomic<std::size_t> asked{0};
    Bytes late;
    ScriptedRtuPeer peer([&](const Bytes& request, std::size_t index) {
      Bytes reply{request[0], request[1], static_cast<std::uint8_t>(2 * request[5]), request[11], request[12]};
      reply.insert(reply.end(), {0x47, 0x4F, 0, 1, 0, 0, 0, static_cast<std::uint8_t>(index)});
      reply.resize(3 + 2U * request[5]);
      reply = with_crc(reply);
      asked = index;
      if (index == 0) late = reply;
      if (index == 0) return Bytes{};
      if (index == lag) reply.insert(reply.begin(), late.begin(), late.end());
      return reply;
    });
    RtuBus bus(config(peer.device(), kShort, 1));
    const SystemClock clock;
    ModbusStage stage(bus.normal(), stage_config, clock);
    int good = 0;

    for (int i = 0; i < 1000 && good < 5; ++i) {
      const auto state = stage.read_state();
      if (!state) continue;
      ++good;
      EXPECT_EQ(state->boot_counter, asked) << "a reply to another request";
    }

    EXPECT_EQ(good, 5);
  }
}

TEST(RtuBus, InterruptsWhoWaitsForAReplyWhenAHaltIsUrgent) {
  const Bytes halt = bytes("01 10 00 a0 00 03 06 00 00 00 07 5a 5a eb 58");
  ScriptedRtuPeer peer(
      [&](const Bytes& request, std::size_t) { return request == halt ? bytes("01 10 00 a0 00 03 80 2a") : Bytes{}; });
  RtuBus bus(config(peer.device(), 1h, 1));
  const stage::RegisterMap map = stage::own_register_map();
  ModbusHaltLine line(bus.urgent(), bus.prompt(), map);
  std::array<std::uint16_t, 1> word{};
  auto waiting = std::async(std::launch::async, [&] { return bus.normal().read_registers(0, word); });
  peer.wait_for_requests(1);

  const auto halted = line.halt(7);

  const auto interrupted = waiting.get();  // an hour early
  ASSERT_TRUE(halted) << describe(halted.error());
  ASSERT_FALSE(interrupted.has_value());
  EXPECT_EQ(interrupted.error().code, ErrorCode::Unreachable);
  peer.wait_for_requests(2);
  EXPECT_EQ(peer.requests().at(1), halt);
}

TEST(RtuBus, InterruptsWhoWaitsForTheLineToBecomeQuietWhenAHaltIsUrgent) {
  ScriptedRtuPeer peer([](const Bytes& request, std::size_t index) {
    if (request[1] == 0x10) return bytes("01 10 00 a0 00 03 80 2a");
    return bytes(index == 0 ? "01 41 c0 10 00" : "");  // nothing that is a reply
  });
  RtuBus bus(config(peer.device(), 1h, 1));
  const stage::RegisterMap map = stage::own_register_map();
  ModbusHaltLine line(bus.urgent(), bus.prompt(), map);
  std::array<std::uint16_t, 1> word{};
  ASSERT_FALSE(bus.normal().read_registers(0, word));
  auto waiting = std::async(std::launch::async, [&] { return bus.normal().read_registers(0, word); });

  const auto halted = line.halt(7);
  bus.normal().interrupt();

  ASSERT_TRUE(halted) << describe(halted.error());
  EXPECT_FALSE(waiting.get().has_value());  // an hour early
}

TEST(RtuBus, DoesNotTakeTheReplyOfAnInterruptedCallForThatOfTheHalt) {
  std::atomic<int> halts{0};
  ScriptedRtuPeer peer([&](const Bytes& request, std::size_t) {
    if (request[1] == 0x03) return Bytes{};
    Bytes reply = bytes("01 10 00 a0 00 03 80 2a");
    const Bytes stale = with_crc(bytes("01 03 02 00 07"));
    if (++halts == 1) reply = stale;  // the slave was busy with it, and did not hear the halt
    return reply;
  });
  RtuBus bus(config(peer.device(), kPatience, 1));
  const stage::RegisterMap map = stage::own_register_map();
  ModbusHaltLine line(bus.urgent(), bus.prompt(), map);
  std::array<std::uint16_t, 1> word{};
  auto waiting = std::async(std::launch::async, [&] { return bus.normal().read_registers(0, word); });
  peer.wait_for_requests(1);

  const auto halted = line.halt(7);

  EXPECT_FALSE(waiting.get().has_value());
  ASSERT_TRUE(halted) << describe(halted.error());
  EXPECT_EQ(halts, 2);
}

TEST(RtuBus, LetsABeatWaitForWhoHasTheLine) {
  ScriptedRtuPeer peer([](const Bytes& request, std::size_t) { return request[1] == 0x06 ? request : Bytes{}; });
  RtuBus bus(config(peer.device(), kPatience));
  std::array<std::uint16_t, 1> word{};
  const std::array<std::uint16_t, 1> beat{1};
  auto reading = std::async(std::launch::async, [&] { return bus.normal().read_registers(0, word); });
  peer.wait_for_requests(1);
  auto beating = std::async(std::launch::async, [&] { return bus.prompt().write_registers(208, beat); });

  peer.say(bytes(kSeven));

  const auto read = reading.get();
  const auto beaten = beating.get();
  EXPECT_TRUE(read.has_value()) << describe(read.error());
  EXPECT_TRUE(beaten.has_value()) << describe(beaten.error());
  EXPECT_EQ(word[0], 7);
}

TEST(RtuBus, GivesUpAtOnceWhenItIsInterrupted) {
  ScriptedRtuPeer peer(always(""));
  RtuBus bus(config(peer.device(), 1h));
  std::array<std::uint16_t, 1> word{};
  auto waiting = std::async(std::launch::async, [&] { return bus.normal().read_registers(0, word); });
  peer.wait_for_requests(1);

  bus.normal().interrupt();

  const auto done = waiting.get();  // an hour early
  ASSERT_FALSE(done.has_value());
  EXPECT_EQ(done.error().code, ErrorCode::Unreachable);
}

TEST(RtuBus, SaysThatTheDeviceIsNotThere) {
  RtuBus bus(config("/dev/serial/by-id/no-such-adapter", kPatience));
  std::array<std::uint16_t, 1> word{};

  const auto done = bus.normal().read_registers(0, word);

  ASSERT_FALSE(done.has_value());
  EXPECT_EQ(done.error().code, ErrorCode::Unreachable);
  EXPECT_THAT(done.error().seen, HasSubstr("/dev/serial/by-id/no-such-adapter cannot be opened: No such file"));
}

TEST(RtuBus, DoesNotShareTheLineWithAnotherProgram) {
  ScriptedRtuPeer peer(always(kSeven));
  RtuBus first(config(peer.device(), kPatience));
  RtuBus second(config(peer.device(), kPatience));
  std::array<std::uint16_t, 1> word{};
  ASSERT_TRUE(first.normal().read_registers(0, word));

  const auto done = second.normal().read_registers(0, word);

  ASSERT_FALSE(done.has_value());
  EXPECT_EQ(done.error().code, ErrorCode::Unreachable);
  EXPECT_THAT(done.error().seen, HasSubstr("in use by another program"));
}

}  // namespace
}  // namespace gonio::drivers
