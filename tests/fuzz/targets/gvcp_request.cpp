// The simulated camera's control channel: any datagrams, over a real socket, to the server's own thread.
#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "sim/wires/gige_camera_server.h"
#include "sim/wires/sockets.h"
#include "tests/fuzz/bench_scene.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

using Datagram = std::array<std::uint8_t, 1024>;

constexpr std::size_t kMostDatagram = 600;
constexpr int kPatienceMs = 20000;  // a bound against hanging
// An address of this process alone, in 127.0.0.0/8.
std::string own_address() {
  const auto process = static_cast<unsigned>(::getpid());
  return "127.213." + std::to_string(process >> 8U & 0xFFU) + "." + std::to_string(1 + process % 250);
}

class Camera {
 public:
  Camera()
      : instrument_(bench_scene(), {}, clock_),
        server_(sim::GigeCameraServer::start(instrument_, own_address()).value()),
        socket_(sim::bind_udp("127.0.0.1", 0).value()) {
    to_.sin_family = AF_INET;
    to_.sin_port = htons(sim::kGvcpPort);
    ::inet_pton(AF_INET, own_address().c_str(), &to_.sin_addr);
  }

  void send(Bytes bytes) {
    ::sendto(socket_.get(), bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to_), sizeof to_);
  }
  // Asks who is there, and takes what comes up to the answer: everything sent before has been served by then.
  void settle() {
    const std::uint16_t id = ++asked_ == 0 ? ++asked_ : asked_;
    send(std::array<std::uint8_t, 8>{0x42, 0x01, 0x00, 0x02, 0x00, 0x00, static_cast<std::uint8_t>(id >> 8U),
                                     static_cast<std::uint8_t>(id)});
    for (;;) {
      Datagram in{};
      hold(answer_comes(), "the camera still answers");
      const ssize_t n = ::recv(socket_.get(), in.data(), in.size(), 0);
      if (n < 0) continue;
      const Bytes answer = Bytes(in).first(static_cast<std::size_t>(n));
      hold_acknowledge(answer);
      if (answer[3] == 0x03 && answer[6] == (id >> 8U) && answer[7] == (id & 0xFFU)) return;
    }
  }
  void give_up_control() {
    send(std::array<std::uint8_t, 16>{0x42, 0x01, 0x00, 0x82, 0x00, 0x08, 0x00, 0x01, 0x00, 0x00, 0x0A, 0x00, 0x00,
                                      0x00, 0x00, 0x00});
    settle();
  }

 private:
  // libFuzzer's own alarm interrupts a wait.
  bool answer_comes() {
    pollfd watched{socket_.get(), POLLIN, 0};
    int ready = -1;
    do ready = ::poll(&watched, 1, kPatienceMs);
    while (ready < 0 && errno == EINTR);
    return ready == 1;
  }
  // GigE Vision 2.0, section 15: status, command, length, id, then as many bytes as the length says.
  static void hold_acknowledge(Bytes answer) {
    hold(answer.size() >= 8, "an acknowledge has a header");
    const std::size_t length = answer[4] * 256U + answer[5];
    hold(answer.size() == 8 + length, "an acknowledge is as long as it says");
    const unsigned status = answer[0] * 256U + answer[1];
    hold(status == 0 || (status >= 0x8001 && status <= 0x8007), "a status is of the standard");
  }

  ManualClock clock_;
  sim::LiveInstrument instrument_;
  std::unique_ptr<sim::GigeCameraServer> server_;
  sim::FileDescriptor socket_;
  sockaddr_in to_{};
  std::uint16_t asked_ = 0;
};

}  // namespace

void gvcp_request(Bytes input) {
  static Camera camera;
  ByteSource source(input);
  for (int datagram = 0; datagram < 16 && !source.is_empty(); ++datagram) {
    camera.send(source.some(std::min<std::size_t>(kMostDatagram, source.word())));
  }
  camera.settle();
  camera.give_up_control();
}

}  // namespace gonio::fuzz
