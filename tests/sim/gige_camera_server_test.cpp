// The camera's wire, byte by byte, as GigE Vision 2.0 writes it (GVCP: section 15; GVSP: section 24; registers: section
// 28): key 0x42, flags, command (2), length (2), id (2), payload; answered by status (2), command + 1 (2), length (2),
// id (2), payload.
#include "sim/wires/gige_camera_server.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "sim/wires/big_endian.h"
#include "tests/sim/bench.h"

namespace gonio::sim::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr int kPatienceMs = 20000;  // a bound against hanging

std::string host(const std::string& numbers) {
  return "127." + numbers;
}

// An address for this test program, so that several run side by side.
std::string own_address() {
  const auto pid = static_cast<unsigned>(::getpid());
  return host(std::to_string(1 + pid / 250 % 250) + "." + std::to_string(1 + pid % 250) + ".9");
}

Bytes u16(std::uint32_t v) {
  Bytes b;
  append16(b, v);
  return b;
}
Bytes u32(std::uint32_t v) {
  Bytes b;
  append32(b, v);
  return b;
}
Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A UDP socket that speaks GVCP by hand, and receives GVSP.
class Controller {
 public:
  explicit Controller(const std::string& camera) : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    to_.sin_family = AF_INET;
    to_.sin_port = htons(3956);
    inet_pton(AF_INET, camera.c_str(), &to_.sin_addr);
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
  }
  void send(const Bytes& datagram) {
    ::sendto(socket_.get(), datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to_), sizeof to_);
  }
  Bytes receive() {
    pollfd watched{socket_.get(), POLLIN, 0};
    if (::poll(&watched, 1, kPatienceMs) != 1) return {};
    Bytes datagram(9000);
    const ssize_t n = ::recv(socket_.get(), datagram.data(), datagram.size(), 0);
    datagram.resize(n < 0 ? 0 : static_cast<std::size_t>(n));
    return datagram;
  }
  Bytes ask(std::uint16_t command, const Bytes& payload) {
    ++id_;
    send(Bytes{0x42, 0x01} + u16(command) + u16(static_cast<std::uint32_t>(payload.size())) + u16(id_) + payload);
    return receive();
  }
  std::uint32_t read(std::uint32_t at) {
    const Bytes answer = ask(0x0080, u32(at));
    return answer.size() == 12 ? get32(answer, 8) : 0xDEADDEAD;
  }
  /// The status of the answer.
  std::uint16_t write(std::uint32_t at, std::uint32_t value) {
    const Bytes answer = ask(0x0082, u32(at) + u32(value));
    return answer.size() >= 8 ? get16(answer, 0) : std::uint16_t{0xFFFF};
  }
  std::uint16_t write_number(std::uint32_t at, double value) {
    Bytes number(8);
    put_double(number, 0, value);
    const Bytes answer = ask(0x0086, u32(at) + number);
    return answer.size() >= 8 ? get16(answer, 0) : std::uint16_t{0xFFFF};
  }
  double read_number(std::uint32_t at) {
    const Bytes answer = ask(0x0084, u32(at) + u32(8));
    return answer.size() == 20 ? get_double(answer, 12) : -1.0;
  }
  std::uint16_t port() { return port_of(socket_); }
  std::uint16_t last_id() const { return id_; }

 private:
  FileDescriptor socket_;
  sockaddr_in to_{};
  std::uint16_t id_ = 0;
};

class GigeCameraServerTest : public testing::Test {
 protected:
  GigeCameraServerTest() : instrument_(quiet_scene(), {}, clock_), address_(own_address()) {
    auto server = GigeCameraServer::start(instrument_, address_);
    EXPECT_TRUE(server.has_value()) << describe(server.error());
    server_ = *std::move(server);
  }

  // Control, stream to `stream`, exposure of 1 ms, acquisition running.
  static void start_stream(Controller& controller, Controller& stream) {
    EXPECT_EQ(controller.write(0x0A00, 2), 0);
    EXPECT_EQ(controller.write(0x0D00, stream.port()), 0);
    EXPECT_EQ(controller.write(0x0D18, 0x7F000001), 0);
    EXPECT_EQ(controller.write(0x0D04, 1400), 0);
    EXPECT_EQ(controller.write_number(address::kExposureUs, 1000.0), 0);
    EXPECT_EQ(controller.write(address::kTriggerMode, 1), 0);
    EXPECT_EQ(controller.write(address::kAcquisition, 1), 0);
  }

  SystemClock clock_;
  LiveInstrument instrument_;
  std::string address_;
  std::unique_ptr<GigeCameraServer> server_;
};

TEST_F(GigeCameraServerTest, AnswersDiscoveryWithWhoItIs) {
  Controller controller(address_);

  const Bytes answer = controller.ask(0x0002, {});

  ASSERT_EQ(answer.size(), 8U + 0xF8U);
  EXPECT_EQ(Bytes(answer.begin(), answer.begin() + 8), (Bytes{0, 0, 0, 3, 0, 0xF8, 0, 1}));
  EXPECT_EQ(get32(answer, 8 + 0x24), ntohl(inet_addr(address_.c_str())));
  EXPECT_STREQ(reinterpret_cast<const char*>(&answer[8 + 0xD8]), "SIM-0001");
}

TEST_F(GigeCameraServerTest, AnswersAReadOfOneRegister) {
  Controller controller(address_);

  const Bytes answer = controller.ask(0x0080, u32(0x0938));

  EXPECT_EQ(answer, (Bytes{0, 0, 0, 0x81, 0, 4, 0, 1, 0, 0, 0x0B, 0xB8})) << "heartbeat timeout: 3000 ms";
}

TEST_F(GigeCameraServerTest, AnswersAReadOfMemoryWithItsAddressFirst) {
  Controller controller(address_);

  const Bytes answer = controller.ask(0x0084, u32(0x0200) + u32(32));

  ASSERT_EQ(answer.size(), 8U + 4U + 32U);
  EXPECT_EQ(get32(answer, 8), 0x0200U);
  EXPECT_EQ(std::string(answer.begin() + 12, answer.begin() + 18), "Local:");
}

TEST_F(GigeCameraServerTest, HandsOutTheDescriptionThatItsUrlNames) {
  Controller controller(address_);
  const Bytes url = controller.ask(0x0084, u32(0x0200) + u32(64));
  unsigned at = 0;
  unsigned size = 0;
  ASSERT_EQ(std::sscanf(reinterpret_cast<const char*>(&url[12]), "Local:goniosim.xml;%x;%x", &at, &size), 2);

  std::string xml;
  while (xml.size() < size) {
    const std::uint32_t count =
        std::min<std::uint32_t>(512, (size - static_cast<std::uint32_t>(xml.size()) + 3) / 4 * 4);
    const Bytes part = controller.ask(0x0084, u32(at + static_cast<std::uint32_t>(xml.size())) + u32(count));
    ASSERT_EQ(part.size(), 12U + count);
    xml.append(part.begin() + 12, part.end());
  }
  xml.resize(size);

  EXPECT_THAT(xml, testing::StartsWith("<?xml"));
  EXPECT_THAT(xml, testing::EndsWith("</RegisterDescription>\n"));
  for (const char* feature : {"ExposureTime", "Gain", "TriggerSoftware", "DeviceTemperature", "PixelFormat"}) {
    EXPECT_THAT(xml, testing::HasSubstr("Name=\"" + std::string(feature) + "\"")) << feature;
  }
}

TEST_F(GigeCameraServerTest, RefusesWithTheStatusOfTheSpecification) {
  Controller controller(address_);
  ASSERT_EQ(controller.write(0x0A00, 2), 0);

  EXPECT_EQ(get16(controller.ask(0x0080, u32(0x00F00000)), 0), 0x8003) << "no such address";
  EXPECT_EQ(get16(controller.ask(0x0080, u32(0x0002)), 0), 0x8005) << "odd address";
  EXPECT_EQ(controller.write(0x0024, 1), 0x8004) << "read only";
  EXPECT_EQ(controller.write(address::kPixelFormat, 0x01080001), 0x8002) << "Mono8";
  EXPECT_EQ(controller.write(address::kWidth, 65), 0x8002) << "wider than the sensor";
  EXPECT_EQ(controller.write(address::kOffsetX, 1), 0x8002) << "beyond its edge";
  EXPECT_EQ(get16(controller.ask(0x00F0, {}), 0), 0x8001) << "no such command";
}

TEST_F(GigeCameraServerTest, LetsOnlyItsControllerWrite) {
  Controller first(address_);
  Controller second(address_);
  EXPECT_EQ(first.write(address::kTriggerMode, 1), 0x8006) << "without control";
  ASSERT_EQ(first.write(0x0A00, 2), 0);

  EXPECT_EQ(second.write(0x0A00, 2), 0x8006);
  EXPECT_EQ(second.write(address::kTriggerMode, 1), 0x8006);
  EXPECT_EQ(second.read(0x0A00), 2U) << "reading is free";

  ASSERT_EQ(first.write(0x0A00, 0), 0);
  EXPECT_EQ(second.write(0x0A00, 2), 0);
}

TEST_F(GigeCameraServerTest, ReleasesAControllerThatFallsSilent) {
  Controller killed(address_);
  ASSERT_EQ(killed.write(0x0A00, 2), 0);
  ASSERT_EQ(killed.write(0x0938, 500), 0);
  Controller next(address_);

  const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(kPatienceMs);
  while (next.read(0x0A00) != 0 && std::chrono::steady_clock::now() < deadline) {
  }

  EXPECT_EQ(next.write(0x0A00, 2), 0);
}

TEST_F(GigeCameraServerTest, KeepsASettingThatItDoesNotTakeAsItWas) {
  Controller controller(address_);
  ASSERT_EQ(controller.write(0x0A00, 2), 0);
  ASSERT_EQ(controller.write_number(address::kExposureUs, 2000.0), 0);

  EXPECT_EQ(controller.write_number(address::kExposureUs, 5e9), 0x8002);
  EXPECT_EQ(controller.read_number(address::kExposureUs), 2000.0);
  EXPECT_EQ(controller.write_number(address::kGainDb, -1.0), 0x8002);
  EXPECT_EQ(controller.read_number(address::kGainDb), 0.0);
}

/// The packets of one frame by their packet id.
std::vector<Bytes> receive_frame(Controller& stream, std::size_t packets) {
  std::vector<Bytes> frame(packets);
  for (std::size_t k = 0; k < packets; ++k) {
    const Bytes packet = stream.receive();
    if (packet.size() < 8) break;
    const std::size_t id = get32(packet, 4) & 0xFFFFFF;
    if (id < packets) frame[id] = packet;
  }
  return frame;
}

// 64 x 64 pixels of 2 bytes in packets of 1400 - 36 bytes: 7 of them, with leader and trailer.
constexpr std::size_t kPackets = (64 * 64 * 2 + 1363) / 1364 + 2;

TEST_F(GigeCameraServerTest, SendsAFrameAsLeaderDataAndTrailer) {
  Controller controller(address_);
  Controller stream(address_);
  start_stream(controller, stream);

  ASSERT_EQ(controller.write(address::kTriggerSoftware, 1), 0);
  const auto frame = receive_frame(stream, kPackets);

  EXPECT_EQ(Bytes(frame[0].begin(), frame[0].begin() + 8), (Bytes{0, 0, 0, 1, 1, 0, 0, 0}))
      << "status, block 1, leader, packet 0";
  EXPECT_EQ(get16(frame[0], 10), 1) << "an image";
  EXPECT_EQ(get32(frame[0], 20), 0x01100005U) << "Mono12";
  EXPECT_EQ(get32(frame[0], 24), 64U);
  EXPECT_EQ(get32(frame[0], 28), 64U);
  EXPECT_EQ(frame[1][4], 3) << "data";
  EXPECT_EQ(frame[1].size(), 1400U - 28U);
  EXPECT_EQ(frame[1][8] | frame[1][9] << 8, 64) << "the offset, low byte first: no light, no noise";
  EXPECT_EQ(frame[kPackets - 1][4], 2) << "trailer";
  EXPECT_EQ(get32(frame[kPackets - 1], 12), 64U);
}

TEST_F(GigeCameraServerTest, SendsPacketsAgainWhenAsked) {
  Controller controller(address_);
  Controller stream(address_);
  start_stream(controller, stream);
  ASSERT_EQ(controller.write(address::kTriggerSoftware, 1), 0);
  const auto frame = receive_frame(stream, kPackets);

  // PACKETRESEND: channel 0, block 1, first and last packet; no acknowledge.
  controller.send(Bytes{0x42, 0x00, 0x00, 0x40, 0x00, 0x0C, 0x00, 0x63} + u16(0) + u16(1) + u32(2) + u32(3));
  Bytes again = stream.receive();
  const Bytes third = stream.receive();

  ASSERT_GE(again.size(), 8U);
  EXPECT_EQ(get16(again, 0), 0x0100) << "marked as sent again";
  again[0] = 0;
  EXPECT_EQ(again, frame[2]);
  EXPECT_EQ(get32(third, 4) & 0xFFFFFF, 3U);
}

TEST_F(GigeCameraServerTest, RefusesATriggerWhileItExposesOrDoesNotAcquire) {
  Controller controller(address_);
  Controller stream(address_);
  ASSERT_EQ(controller.write(0x0A00, 2), 0);
  EXPECT_EQ(controller.write(address::kTriggerSoftware, 1), 0x8007) << "not acquiring";
  start_stream(controller, stream);
  ASSERT_EQ(controller.write_number(address::kExposureUs, 500000.0), 0);
  ASSERT_EQ(controller.write(address::kTriggerSoftware, 1), 0);

  // Unless this machine stands still for half a second, the second trigger falls into the first exposure.
  const std::uint16_t second = controller.write(address::kTriggerSoftware, 1);
  const auto exposures =
      instrument_.with([](LiveInstrument::Parts& parts) { return parts.instrument.memory(parts.now).exposures; });

  EXPECT_EQ(second == 0x8007 ? 1U : 2U, exposures) << "either refused and not exposed, or taken and exposed";
}

TEST_F(GigeCameraServerTest, NumbersTheFramesOfEachAcquisitionFromOne) {
  Controller controller(address_);
  Controller stream(address_);
  start_stream(controller, stream);
  ASSERT_EQ(controller.write(address::kTriggerSoftware, 1), 0);
  (void)receive_frame(stream, kPackets);
  ASSERT_EQ(controller.write(address::kTriggerSoftware, 1), 0);
  EXPECT_EQ(get16(receive_frame(stream, kPackets)[0], 2), 2);

  ASSERT_EQ(controller.write(address::kAcquisition, 0), 0);
  ASSERT_EQ(controller.write(address::kAcquisition, 1), 0);
  ASSERT_EQ(controller.write(address::kTriggerSoftware, 1), 0);

  EXPECT_EQ(get16(receive_frame(stream, kPackets)[0], 2), 1);
}

TEST_F(GigeCameraServerTest, ComesBackFromSilenceWithoutControllerAndSettings) {
  Controller controller(address_);
  Controller stream(address_);
  start_stream(controller, stream);
  ASSERT_EQ(controller.write_number(address::kExposureUs, 3000.0), 0);

  server_->set_silent(true);
  server_->set_silent(false);

  EXPECT_EQ(controller.read(0x0A00), 0U);
  EXPECT_NEAR(controller.read_number(address::kExposureUs), 1000.0, 0.01) << "the shortest exposure";
}

TEST_F(GigeCameraServerTest, SaysThatItsAddressIsTakenOrNotOurs) {
  const auto second = GigeCameraServer::start(instrument_, address_);
  const auto nowhere = GigeCameraServer::start(instrument_, "no address");

  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code, ErrorCode::PortBusy);
  ASSERT_FALSE(nowhere.has_value());
  EXPECT_EQ(nowhere.error().code, ErrorCode::InvalidInput);
}

}  // namespace
}  // namespace gonio::sim::test
