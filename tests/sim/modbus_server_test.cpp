// The stage's wire, byte by byte, as the Modbus Application Protocol V1.1b3 and Modbus Messaging on TCP/IP V1.0b write
// it: transaction (2), protocol 0 (2), length (2), unit (1), function (1), data; all high byte first.
#include "sim/wires/modbus_server.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <string>
#include <thread>
#include <vector>

#include "tests/sim/bench.h"
#include "tests/sim/hex_bytes.h"

namespace gonio::sim::test {
namespace {

constexpr int kPatienceMs = 20000;  // a bound against hanging

/// A plain socket that speaks bytes.
class Master {
 public:
  explicit Master(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  }
  void send(const std::string& hex) {
    const auto out = bytes(hex);
    EXPECT_EQ(::send(socket_.get(), out.data(), out.size(), MSG_NOSIGNAL), static_cast<ssize_t>(out.size()));
  }
  /// The next `count` bytes; fewer when the connection ends.
  std::vector<std::uint8_t> receive(std::size_t count) {
    std::vector<std::uint8_t> in;
    while (in.size() < count) {
      pollfd watched{socket_.get(), POLLIN, 0};
      if (::poll(&watched, 1, kPatienceMs) != 1) break;
      std::vector<std::uint8_t> part(count - in.size());
      const ssize_t n = ::recv(socket_.get(), part.data(), part.size(), 0);
      if (n <= 0) break;
      in.insert(in.end(), part.begin(), part.begin() + n);
    }
    return in;
  }
  std::vector<std::uint8_t> ask(const std::string& hex, std::size_t count) {
    send(hex);
    return receive(count);
  }
  /// Whether the other side has closed.
  bool is_closed() { return receive(1).empty(); }

 private:
  FileDescriptor socket_;
};

class ModbusServerTest : public testing::Test {
 protected:
  ModbusServerTest() : instrument_(quiet_scene(), {}, clock_) {
    auto server = ModbusServer::start(instrument_, "127.0.0.1", 0);
    EXPECT_TRUE(server.has_value());
    server_ = *std::move(server);
  }
  ManualClock clock_;
  LiveInstrument instrument_;
  std::unique_ptr<ModbusServer> server_;
};

TEST_F(ModbusServerTest, AnswersReadHoldingRegistersWithTheBytesOfTheSpecification) {
  Master master(server_->port());

  // Registers 1 and 2: identity 0x474F, map version 1.
  EXPECT_EQ(master.ask("1234 0000 0006 01 03 0001 0002", 13), bytes("1234 0000 0007 01 03 04 474F 0001"));
}

TEST_F(ModbusServerTest, EchoesAWriteOfOneRegister) {
  Master master(server_->port());

  EXPECT_EQ(master.ask("0001 0000 0006 01 06 0000 BEEF", 12), bytes("0001 0000 0006 01 06 0000 BEEF"));
  EXPECT_EQ(master.ask("0002 0000 0006 01 03 0000 0001", 11), bytes("0002 0000 0005 01 03 02 BEEF"));
}

TEST_F(ModbusServerTest, AnswersAWriteOfManyRegistersWithAddressAndCountAndActsOnIt) {
  Master master(server_->port());
  const stage::Block halt = stage::own_register_map().halt_block();
  ASSERT_EQ(halt.first, 160);  // epoch (2 words), key

  EXPECT_EQ(master.ask("0003 0000 000D 01 10 00A0 0003 06 0000 0007 5A5A", 12),
            bytes("0003 0000 0006 01 10 00A0 0003"));

  instrument_.with([](LiveInstrument::Parts& parts) {
    EXPECT_TRUE(parts.instrument.stage().is_halted());
    EXPECT_EQ(parts.instrument.stage().epoch(), 7U);
  });
}

TEST_F(ModbusServerTest, WritesBeforeItReadsInOneExchange) {
  Master master(server_->port());

  // FC 23: read 2 registers from 0, write 1 register at 0.
  EXPECT_EQ(master.ask("0004 0000 000D 01 17 0000 0002 0000 0001 02 CAFE", 13),
            bytes("0004 0000 0007 01 17 04 CAFE 474F"));
}

TEST_F(ModbusServerTest, AnswersWhatItCannotDoWithTheExceptionsOfTheSpecification) {
  Master master(server_->port());

  EXPECT_EQ(master.ask("0001 0000 0006 01 01 0000 0001", 9), bytes("0001 0000 0003 01 81 01")) << "no coils";
  EXPECT_EQ(master.ask("0002 0000 0006 01 03 FFFF 0002", 9), bytes("0002 0000 0003 01 83 02")) << "no such register";
  EXPECT_EQ(master.ask("0003 0000 0006 01 03 0000 007E", 9), bytes("0003 0000 0003 01 83 03")) << "126 registers";
  EXPECT_EQ(master.ask("0004 0000 0006 01 03 0000 0000", 9), bytes("0004 0000 0003 01 83 03")) << "0 registers";
  EXPECT_EQ(master.ask("0005 0000 0006 01 06 0001 0000", 9), bytes("0005 0000 0003 01 86 02")) << "read only";
  EXPECT_EQ(master.ask("0006 0000 0009 01 10 0000 0001 03 0000", 9), bytes("0006 0000 0003 01 90 03"))
      << "wrong byte count";
  EXPECT_EQ(master.ask("0007 0000 0006 02 03 0000 0001", 9), bytes("0007 0000 0003 02 83 0B")) << "another unit";
  EXPECT_EQ(master.ask("0008 0000 000D 01 10 00A0 0003 06 0000 0007 0000", 9), bytes("0008 0000 0003 01 90 03"))
      << "wrong key";
}

TEST_F(ModbusServerTest, RefusesAFunctionThatOnlyAnExceptionMayBear) {
  Master master(server_->port());

  EXPECT_EQ(master.ask("0001 0000 0006 01 83 0001 0002", 9), bytes("0001 0000 0003 01 83 01"));
}

TEST_F(ModbusServerTest, AnswersRequestsThatArriveTogetherOneByOne) {
  Master master(server_->port());

  const auto replies = master.ask("0001 0000 0006 01 03 0001 0001 0002 0000 0006 01 03 0002 0001", 22);

  EXPECT_EQ(replies, bytes("0001 0000 0005 01 03 02 474F 0002 0000 0005 01 03 02 0001"));
}

TEST_F(ModbusServerTest, StopsTheStageWhileAnotherClientStallsInMidFrame) {
  Master stalled(server_->port());
  Master stopper(server_->port());
  stalled.send("0001 0000 0006 01 03");

  EXPECT_EQ(stopper.ask("0003 0000 000D 01 10 00A0 0003 06 0000 0001 5A5A", 12).size(), 12U);

  instrument_.with([](LiveInstrument::Parts& parts) { EXPECT_TRUE(parts.instrument.stage().is_halted()); });
  EXPECT_EQ(stalled.ask("0001 0001", 11), bytes("0001 0000 0005 01 03 02 474F")) << "and its request is still good";
}

TEST_F(ModbusServerTest, StopsTheStageWhileAnotherClientAsksAndNeverReads) {
  Master greedy(server_->port());
  Master stopper(server_->port());
  for (int k = 0; k < 2000; ++k) greedy.send("0001 0000 0006 01 03 0000 0050");

  EXPECT_EQ(stopper.ask("0003 0000 000D 01 10 00A0 0003 06 0000 0001 5A5A", 12).size(), 12U);
}

TEST_F(ModbusServerTest, ClosesAConnectionThatIsOutOfStep) {
  Master wrong_protocol(server_->port());
  Master too_long(server_->port());

  wrong_protocol.send("0001 0001 0006 01 03 0001 0001");
  too_long.send("0001 0000 FFFF 01 03 0001 0001");

  EXPECT_TRUE(wrong_protocol.is_closed());
  EXPECT_TRUE(too_long.is_closed());
}

TEST_F(ModbusServerTest, NeitherActsNorAnswersWhileItIsSilent) {
  Master master(server_->port());
  server_->set_silent(true);
  master.send("0003 0000 000D 01 10 00A0 0003 06 0000 0001 5A5A");
  // Out of step, so closed even in silence: by then the halt, which came before it, has been read.
  master.send("0001 0001 0006 01 03 0001 0001");
  EXPECT_TRUE(master.is_closed());

  instrument_.with([](LiveInstrument::Parts& parts) { EXPECT_FALSE(parts.instrument.stage().is_halted()); });
  server_->set_silent(false);
  Master again(server_->port());
  EXPECT_EQ(again.ask("0002 0000 0006 01 03 0001 0001", 11).size(), 11U);
}

TEST_F(ModbusServerTest, ClosesAllConnectionsWhileItRefuses) {
  Master before(server_->port());
  EXPECT_EQ(before.ask("0001 0000 0006 01 03 0001 0001", 11).size(), 11U);

  server_->set_refusing(true);
  EXPECT_TRUE(before.is_closed());
  Master during(server_->port());
  EXPECT_TRUE(during.is_closed());

  server_->set_refusing(false);
  Master after(server_->port());
  EXPECT_EQ(after.ask("0001 0000 0006 01 03 0001 0001", 11).size(), 11U);
}

TEST_F(ModbusServerTest, SaysThatAPortIsBusy) {
  const auto second = ModbusServer::start(instrument_, "127.0.0.1", server_->port());

  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code, ErrorCode::PortBusy);
}

}  // namespace
}  // namespace gonio::sim::test
