// The stage's serial wire, byte by byte, as the Modbus Application Protocol V1.1b3 and Modbus over Serial Line V1.02
// write it: unit (1), function (1), data, CRC (2, low byte first). The CRCs were computed apart.
#include "sim/wires/rtu_server.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "sim/wires/rtu_frame.h"
#include "tests/sim/bench.h"
#include "tests/sim/hex_bytes.h"
#include "tests/support/process.h"

namespace gonio::sim::test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using namespace std::chrono_literals;

constexpr int kPatienceMs = 20000;  // a bound against hanging

/// The open end of a line, opened as any program would.
class Master {
 public:
  explicit Master(const std::string& device) : tty_(::open(device.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC)) {}
  void send(const std::string& hex) {
    const auto out = bytes(hex);
    EXPECT_EQ(::write(tty_.get(), out.data(), out.size()), static_cast<ssize_t>(out.size()));
  }
  /// The next `count` bytes; fewer when the line ends.
  Bytes receive(std::size_t count) {
    Bytes in;
    while (in.size() < count) {
      pollfd watched{tty_.get(), POLLIN, 0};
      if (::poll(&watched, 1, kPatienceMs) != 1) break;
      Bytes part(count - in.size());
      const ssize_t n = ::read(tty_.get(), part.data(), part.size());
      if (n <= 0) break;
      in.insert(in.end(), part.begin(), part.begin() + n);
    }
    return in;
  }
  Bytes ask(const std::string& hex, std::size_t count) {
    send(hex);
    return receive(count);
  }
  bool has_ended() {
    pollfd watched{tty_.get(), POLLIN, 0};
    return ::poll(&watched, 1, kPatienceMs) == 1 && (watched.revents & POLLHUP) != 0;
  }

 private:
  FileDescriptor tty_;
};

TEST(RtuFrame, BearsTheCrcOfTheStandardsExample) {
  // Modbus over Serial Line V1.02, 6.2.2: message 02 07.
  EXPECT_EQ(modbus_crc(bytes("02 07")), 0x1241);
  EXPECT_EQ(rtu_frame(0x02, bytes("07")), bytes("02 07 41 12"));
  EXPECT_TRUE(has_good_crc(bytes("11 03 00 6b 00 03 76 87")));
  EXPECT_FALSE(has_good_crc(bytes("11 03 00 6b 00 03 87 76")));
}

TEST(RtuFrame, KnowsTheLengthOfARequestByItsFunction) {
  EXPECT_EQ(rtu_request_length(bytes("11 03")), 8U);
  EXPECT_EQ(rtu_request_length(bytes("11 06 00")), 8U);
  EXPECT_EQ(rtu_request_length(bytes("11 10 00 01 00 02")), std::nullopt) << "not yet";
  EXPECT_EQ(rtu_request_length(bytes("11 10 00 01 00 02 04")), 13U);
  EXPECT_EQ(rtu_request_length(bytes("11 17 00 03 00 06 00 0e 00 03 06")), 19U);
  EXPECT_EQ(rtu_request_length(bytes("11 41 00 00")), std::nullopt) << "not a function of the standard";
}

class RtuServerTest : public testing::Test {
 protected:
  explicit RtuServerTest(RtuTiming timing = {.baud = 921600, .turnaround = 0ms})
      : instrument_(quiet_scene(), {}, clock_) {
    auto server = RtuServer::start(instrument_, link_, timing);
    EXPECT_TRUE(server.has_value()) << describe(server.error());
    server_ = *std::move(server);
  }
  // Of the next request, whatever it is.
  void arm(FaultKind kind) {
    PlannedFault fault{.kind = kind};
    fault.values[FaultParameter::Exchange] = static_cast<double>(ExchangeKind::Any);
    fault.values[FaultParameter::LateWallS] = 0.1;
    instrument_.with([&](LiveInstrument::Parts& parts) { EXPECT_TRUE(parts.instrument.arm(fault, parts.now)); });
  }
  gonio::test::TemporaryFolder folder_;
  const std::string link_ = folder_ / "stage.tty";
  ManualClock clock_;
  LiveInstrument instrument_;
  std::unique_ptr<RtuServer> server_;
};

TEST_F(RtuServerTest, AnswersReadHoldingRegistersWithTheBytesOfTheSpecification) {
  Master master(link_);

  // Registers 1 and 2: identity 0x474F, map version 1.
  EXPECT_EQ(master.ask("01 03 0001 0002 95cb", 9), bytes("01 03 04 474F 0001 1e90"));
}

TEST_F(RtuServerTest, EchoesAWriteOfOneRegister) {
  Master master(link_);

  EXPECT_EQ(master.ask("01 06 0000 BEEF b9e6", 8), bytes("01 06 0000 BEEF b9e6"));
}

TEST_F(RtuServerTest, ActsOnAWriteOfManyRegisters) {
  Master master(link_);

  EXPECT_EQ(master.ask("01 10 00A0 0003 06 0000 0007 5A5A eb58", 8), bytes("01 10 00A0 0003 802a"));

  instrument_.with([](LiveInstrument::Parts& parts) {
    EXPECT_TRUE(parts.instrument.stage().is_halted());
    EXPECT_EQ(parts.instrument.stage().epoch(), 7U);
  });
}

TEST_F(RtuServerTest, WritesBeforeItReadsInOneExchange) {
  Master master(link_);

  EXPECT_EQ(master.ask("01 17 0000 0002 0000 0001 02 CAFE c39b", 9), bytes("01 17 04 CAFE 474F d50b"));
}

TEST_F(RtuServerTest, AnswersWhatItCannotDoWithTheExceptionsOfTheSpecification) {
  Master master(link_);

  EXPECT_EQ(master.ask("01 03 FFFF 0002 c42f", 5), bytes("01 83 02 c0f1")) << "no such register";
  EXPECT_EQ(master.ask("01 41 c010", 5), bytes("01 c1 01 b050")) << "a function that nobody knows ends with a silence";
}

TEST_F(RtuServerTest, PassesOverWhatIsNotForIt) {
  Master master(link_);

  master.send("02 03 0001 0002 95f8");  // another unit
  master.send("01 03 0001 0002 cb95");  // wrong CRC

  EXPECT_EQ(master.ask("01 03 0001 0002 95cb", 9), bytes("01 03 04 474F 0001 1e90")) << "and nothing before it";
  EXPECT_EQ(server_->requests(), 1U);
}

TEST_F(RtuServerTest, TakesARequestThatComesInPieces) {
  Master master(link_);

  master.send("01 03 00");

  EXPECT_EQ(master.ask("01 0002 95cb", 9), bytes("01 03 04 474F 0001 1e90"));
}

TEST_F(RtuServerTest, SpoilsRepliesByNameAndObeysAllTheSame) {
  Master master(link_);
  const std::string write = "01 06 0000 BEEF b9e6";

  arm(FaultKind::ReplyBadCrc);
  EXPECT_EQ(master.ask(write, 8), bytes("01 06 0000 BEEF b919"));
  arm(FaultKind::ReplyWrongUnit);
  EXPECT_EQ(master.ask(write, 8).front(), 2);
  arm(FaultKind::ReplyTorn);
  EXPECT_EQ(master.ask(write, 4), bytes("01 06 0000"));
  arm(FaultKind::ReplyLost);
  master.send("01 10 00A0 0003 06 0000 0007 5A5A eb58");
  EXPECT_EQ(master.ask("01 03 0001 0002 95cb", 9), bytes("01 03 04 474F 0001 1e90")) << "the halt is not answered";

  instrument_.with([](LiveInstrument::Parts& parts) { EXPECT_TRUE(parts.instrument.stage().is_halted()); });
}

TEST_F(RtuServerTest, SendsALateReplyAfterThatToALaterRequest) {
  Master master(link_);
  arm(FaultKind::ReplyLate);
  master.send("01 06 0000 BEEF b9e6");

  const auto first = master.ask("01 03 0001 0002 95cb", 9);
  const auto second = master.receive(8);

  EXPECT_EQ(first, bytes("01 03 04 474F 0001 1e90"));
  EXPECT_EQ(second, bytes("01 06 0000 BEEF b9e6"));
}

TEST_F(RtuServerTest, NeitherActsNorAnswersWhileItIsSilent) {
  Master master(link_);
  server_->set_silent(true);
  master.send("01 10 00A0 0003 06 0000 0007 5A5A eb58");
  while (server_->requests() < 1) std::this_thread::yield();

  server_->set_silent(false);

  EXPECT_EQ(master.ask("01 03 0001 0002 95cb", 9), bytes("01 03 04 474F 0001 1e90"));
  instrument_.with([](LiveInstrument::Parts& parts) { EXPECT_FALSE(parts.instrument.stage().is_halted()); });
}

TEST_F(RtuServerTest, IsGoneWhileItRefusesAndBackUnderTheSameLink) {
  Master before(link_);
  server_->set_refusing(true);
  EXPECT_TRUE(before.has_ended());

  server_->set_refusing(false);

  EXPECT_TRUE(gonio::test::eventually([&] { return std::filesystem::exists(link_); }, std::chrono::seconds(60)));
  Master after(link_);
  EXPECT_EQ(after.ask("01 03 0001 0002 95cb", 9), bytes("01 03 04 474F 0001 1e90"));
}

TEST_F(RtuServerTest, LeavesNoLinkBehind) {
  server_.reset();

  EXPECT_FALSE(std::filesystem::is_symlink(link_));
}

class SlowRtuServerTest : public RtuServerTest {
 protected:
  SlowRtuServerTest() : RtuServerTest({.baud = 9600, .turnaround = 5ms}) {}
};

TEST_F(SlowRtuServerTest, TakesTheTimeThatTheLineWould) {
  Master master(link_);
  const SystemClock wall;
  const Instant began = wall.now();

  const auto reply = master.ask("01 03 0001 0002 95cb", 9);

  // 8 bytes there, 9 back, 11 bits each at 9600 baud: 19.48 ms; and 5 ms to think.
  EXPECT_EQ(reply.size(), 9U);
  EXPECT_GE(in_seconds(wall.now() - began), 17 * 11.0 / 9600.0 + 0.005);
}

}  // namespace
}  // namespace gonio::sim::test
