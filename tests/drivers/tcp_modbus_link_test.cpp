// Frames are those of the examples in MODBUS Application Protocol V1.1b3, with the header of Messaging on TCP/IP V1.0b.
#include "drivers/links/tcp_modbus_link.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/select.h>
#include <unistd.h>

#include <array>
#include <future>

#include "tests/drivers/scripted_modbus_server.h"

namespace gonio::drivers {
namespace {

using namespace std::chrono_literals;
using test::Bytes;
using test::bytes;
using test::reply_to;
using test::ScriptedModbusServer;
using testing::HasSubstr;
using Answer = ScriptedModbusServer::Answer;

constexpr Duration kPatience = 30s;  // of a reply that does come: never used up, however slow the machine
constexpr Duration kShort = 20ms;    // of one that does not

TcpModbusConfig config(std::uint16_t port, Duration reply_timeout) {
  return {.address = "127.0.0.1",
          .port = port,
          .unit_id = 17,
          .reply_timeout = reply_timeout,
          .connect_timeout = kPatience};
}

// What was sent, without the transaction's number.
Bytes without_transaction(Bytes frame) {
  frame.erase(frame.begin(), frame.begin() + 2);
  return frame;
}

ScriptedModbusServer::Script always(const std::string& pdu) {
  return [pdu](const Bytes& request, int) { return Answer{reply_to(request, bytes(pdu))}; };
}

TEST(TcpModbusLink, ReadsHoldingRegistersAsTheStandardPrintsIt) {
  ScriptedModbusServer server(always("03 06 02 2b 00 00 00 64"));
  TcpModbusLink link(config(server.port(), kPatience));
  std::array<std::uint16_t, 3> words{};

  const auto done = link.read_registers(0x006B, words);

  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_EQ(words, (std::array<std::uint16_t, 3>{0x022B, 0x0000, 0x0064}));
  EXPECT_EQ(without_transaction(server.requests().at(0)), bytes("00 00 00 06 11 03 00 6b 00 03"));
}

TEST(TcpModbusLink, ReadsInputRegistersOfAnotherUnitOverTheSameConnectionAsTheStandardPrintsIt) {
  ScriptedModbusServer server([](const Bytes& request, int) {
    return Answer{reply_to(request, bytes(request[7] == 0x04 ? "04 02 00 0a" : "03 02 00 07"))};
  });
  TcpModbusLink link(config(server.port(), kPatience));
  const auto other = link.for_unit({.unit_id = 5, .reads = stage::ReadFunction::Input});
  std::array<std::uint16_t, 1> own_word{};
  std::array<std::uint16_t, 1> word{};

  const auto own = link.read_registers(8, own_word);
  const auto done = other->read_registers(8, word);

  ASSERT_TRUE(own && done);
  EXPECT_EQ(own_word[0], 7);
  EXPECT_EQ(word[0], 0x000A);
  EXPECT_EQ(without_transaction(server.requests().at(0)), bytes("00 00 00 06 11 03 00 08 00 01"));
  EXPECT_EQ(without_transaction(server.requests().at(1)), bytes("00 00 00 06 05 04 00 08 00 01"));
  EXPECT_EQ(server.connections(), 1);
}

TEST(TcpModbusLink, WritesOneRegisterByTheFunctionForSeveralWhereTheUnitWantsIt) {
  ScriptedModbusServer server(always("10 00 01 00 01"));
  TcpModbusLink link(config(server.port(), kPatience));
  const auto unit = link.for_unit({.unit_id = 5, .writes = stage::WriteFunction::Multiple});
  const std::array<std::uint16_t, 1> words{3};

  const auto done = unit->write_registers(1, words);

  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_EQ(without_transaction(server.requests().at(0)), bytes("00 00 00 09 05 10 00 01 00 01 02 00 03"));
}

TEST(TcpModbusLink, WritesOneRegisterAsTheStandardPrintsIt) {
  ScriptedModbusServer server(always("06 00 01 00 03"));
  TcpModbusLink link(config(server.port(), kPatience));
  const std::array<std::uint16_t, 1> words{3};

  const auto done = link.write_registers(1, words);

  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_EQ(without_transaction(server.requests().at(0)), bytes("00 00 00 06 11 06 00 01 00 03"));
}

TEST(TcpModbusLink, WritesSeveralRegistersAsTheStandardPrintsIt) {
  ScriptedModbusServer server(always("10 00 01 00 02"));
  TcpModbusLink link(config(server.port(), kPatience));
  const std::array<std::uint16_t, 2> words{0x000A, 0x0102};

  const auto done = link.write_registers(1, words);

  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_EQ(without_transaction(server.requests().at(0)), bytes("00 00 00 0b 11 10 00 01 00 02 04 00 0a 01 02"));
}

TEST(TcpModbusLink, WritesAndReadsInOneTransactionAsTheStandardPrintsIt) {
  ScriptedModbusServer server(always("17 0c 00 fe 0a cd 00 01 00 03 00 0d 00 ff"));
  TcpModbusLink link(config(server.port(), kPatience));
  const std::array<std::uint16_t, 3> written{0x00FF, 0x00FF, 0x00FF};
  std::array<std::uint16_t, 6> words{};

  const auto done = link.write_and_read(14, written, 3, words);

  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_EQ(words, (std::array<std::uint16_t, 6>{0x00FE, 0x0ACD, 0x0001, 0x0003, 0x000D, 0x00FF}));
  EXPECT_EQ(without_transaction(server.requests().at(0)),
            bytes("00 00 00 11 11 17 00 03 00 06 00 0e 00 03 06 00 ff 00 ff 00 ff"));
}

TEST(TcpModbusLink, KeepsItsConnectionAfterAnExceptionReply) {
  ScriptedModbusServer server([](const Bytes& request, int) {
    return Answer{reply_to(request, bytes(request[9] == 0 ? "83 02" : "03 02 00 07"))};
  });
  TcpModbusLink link(config(server.port(), kPatience));
  std::array<std::uint16_t, 1> word{};

  const auto refused = link.read_registers(0, word);
  const auto done = link.read_registers(1, word);

  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::DeviceRefused);
  EXPECT_THAT(refused.error().seen, HasSubstr("Illegal data address"));
  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_EQ(server.connections(), 1);
}

TEST(TcpModbusLink, TimesOutAndAsksAgainOnANewConnection) {
  ScriptedModbusServer server([](const Bytes& request, int connection) {
    return connection == 0 ? Answer{} : Answer{reply_to(request, bytes("03 02 00 07"))};
  });
  TcpModbusLink link(config(server.port(), kShort));
  std::array<std::uint16_t, 1> word{};

  const auto lost = link.read_registers(0, word);

  ASSERT_FALSE(lost.has_value());
  EXPECT_EQ(lost.error().code, ErrorCode::TimedOut);
  EXPECT_THAT(lost.error().limit, HasSubstr("20 ms"));
  Result<void> done = link.read_registers(0, word);
  for (int i = 0; i < 1000 && !done; ++i) done = link.read_registers(0, word);  // 20 ms can be short on a busy machine
  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_EQ(word[0], 7);
  EXPECT_GE(server.connections(), 2);
}

TEST(TcpModbusLink, BoundsTheWholeReplyAndNotOnlyTheWaitForItsNextByte) {
  ScriptedModbusServer server([](const Bytes& request, int) {
    Bytes cut = reply_to(request, bytes("03 02 00 07"));
    cut.resize(8);
    return Answer{cut};
  });
  TcpModbusLink link(config(server.port(), kShort));
  std::array<std::uint16_t, 1> word{};

  const auto done = link.read_registers(0, word);

  ASSERT_FALSE(done.has_value());
  EXPECT_EQ(done.error().code, ErrorCode::TimedOut);
}

TEST(TcpModbusLink, RefusesAReplyToAnotherTransactionAndConnectsAnew) {
  ScriptedModbusServer server([](const Bytes& request, int connection) {
    Bytes reply = reply_to(request, bytes("03 02 00 07"));
    if (connection == 0) reply[1] ^= 0x55U;
    return Answer{reply};
  });
  TcpModbusLink link(config(server.port(), kPatience));
  std::array<std::uint16_t, 1> word{};

  const auto wrong = link.read_registers(0, word);
  const auto done = link.read_registers(0, word);

  ASSERT_FALSE(wrong.has_value());
  EXPECT_EQ(wrong.error().code, ErrorCode::BadReply);
  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_EQ(server.connections(), 2);
}

TEST(TcpModbusLink, ConnectsAnewAfterTheServerHungUp) {
  ScriptedModbusServer server([](const Bytes& request, int connection) {
    if (connection == 0) return Answer{{}, true};
    return Answer{reply_to(request, bytes("03 02 00 07"))};
  });
  TcpModbusLink link(config(server.port(), kPatience));
  std::array<std::uint16_t, 1> word{};

  const auto broken = link.read_registers(0, word);
  const auto done = link.read_registers(0, word);

  ASSERT_FALSE(broken.has_value());
  EXPECT_EQ(broken.error().code, ErrorCode::Unreachable);
  ASSERT_TRUE(done) << describe(done.error());
}

TEST(TcpModbusLink, StartsOnAFreshLineAfterAResync) {
  ScriptedModbusServer server(always("03 02 00 07"));
  TcpModbusLink link(config(server.port(), kPatience));
  std::array<std::uint16_t, 1> word{};
  ASSERT_TRUE(link.read_registers(0, word));

  link.resync();

  ASSERT_TRUE(link.read_registers(0, word));
  EXPECT_EQ(server.connections(), 2);
}

TEST(TcpModbusLink, IsUnreachableWhereNobodyListens) {
  std::uint16_t port = 0;
  {
    const ScriptedModbusServer gone(always("03 02 00 07"));
    port = gone.port();
  }
  TcpModbusLink link(config(port, kPatience));
  std::array<std::uint16_t, 1> word{};

  const auto done = link.read_registers(0, word);

  ASSERT_FALSE(done.has_value());
  EXPECT_EQ(done.error().code, ErrorCode::Unreachable);
  EXPECT_THAT(done.error().tried, HasSubstr("connect to 127.0.0.1:"));
}

TEST(TcpModbusLink, LooksUpNoNames) {
  TcpModbusConfig named = config(502, kPatience);
  named.address = "stage.example";
  TcpModbusLink link(named);
  std::array<std::uint16_t, 1> word{};

  const auto done = link.read_registers(0, word);

  ASSERT_FALSE(done.has_value());
  EXPECT_EQ(done.error().code, ErrorCode::InvalidInput);
}

TEST(TcpModbusLink, GivesWayToAnInterruptThatCameBeforeItWasConnected) {
  ScriptedModbusServer server(always("03 02 00 07"));
  TcpModbusLink link(config(server.port(), kPatience));
  std::array<std::uint16_t, 1> word{};

  link.interrupt();
  const auto interrupted = link.read_registers(0, word);
  const auto next = link.read_registers(0, word);

  ASSERT_FALSE(interrupted.has_value());
  EXPECT_EQ(interrupted.error().code, ErrorCode::Unreachable);
  EXPECT_EQ(interrupted.error().seen, "interrupted");
  EXPECT_TRUE(next.has_value());
  EXPECT_EQ(server.requests().size(), 1U);
}

TEST(TcpModbusLink, GivesUpAtOnceWhenItIsInterrupted) {
  ScriptedModbusServer server([](const Bytes&, int) { return Answer{}; });
  TcpModbusLink link(config(server.port(), 1h));
  auto waiting = std::async(std::launch::async, [&] {
    std::array<std::uint16_t, 1> word{};
    return link.read_registers(0, word);
  });
  server.wait_for_requests(1);

  link.interrupt();

  const auto done = waiting.get();  // an hour early
  ASSERT_FALSE(done.has_value());
  EXPECT_EQ(done.error().code, ErrorCode::Unreachable);
}

/// Opens /dev/null until a descriptor of FD_SETSIZE or above is there; closes all at the end.
class ManyOpenFiles {
 public:
  ManyOpenFiles() {
    getrlimit(RLIMIT_NOFILE, &before_);
    rlimit more = before_;
    more.rlim_cur = std::min<rlim_t>(more.rlim_max, FD_SETSIZE + 64);
    setrlimit(RLIMIT_NOFILE, &more);
    while (files_.empty() || files_.back() < FD_SETSIZE) {
      const int fd = open("/dev/null", O_RDONLY | O_CLOEXEC);
      if (fd < 0) break;
      files_.push_back(fd);
    }
  }
  ~ManyOpenFiles() {
    for (const int fd : files_) close(fd);
    setrlimit(RLIMIT_NOFILE, &before_);
  }

 private:
  std::vector<int> files_;
  rlimit before_{};
};

TEST(TcpModbusLink, RefusesADescriptorThatSelectCannotHold) {
  ScriptedModbusServer server(always("03 02 00 07"));
  TcpModbusLink link(config(server.port(), kPatience));
  std::array<std::uint16_t, 1> word{};
  Result<void> done;
  {
    const ManyOpenFiles files;

    done = link.read_registers(0, word);
  }

  ASSERT_FALSE(done.has_value());
  EXPECT_EQ(done.error().code, ErrorCode::Unreachable);
  EXPECT_TRUE(link.read_registers(0, word).has_value()) << "it works again when files were closed";
}

}  // namespace
}  // namespace gonio::drivers
