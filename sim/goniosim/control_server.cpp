#include "sim/goniosim/control_server.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <vector>

namespace gonio::sim {
namespace {

constexpr std::size_t kLongestLine = 64 * 1024;
constexpr std::size_t kMostClients = 16;

// An answer may be longer than a socket buffer; a client that does not read within this is dropped.
constexpr timeval kSendPatience{.tv_sec = 2, .tv_usec = 0};

bool send_all(int socket, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t n = ::send(socket, text.data() + at, text.size() - at, MSG_NOSIGNAL);
    if (n <= 0) return false;
    at += static_cast<std::size_t>(n);
  }
  return true;
}

}  // namespace

Result<std::unique_ptr<ControlServer>> ControlServer::start(const std::string& path, LiveInstrument& instrument,
                                                            const StageWire& stage, UsbPorts* usb) {
  auto listener = listen_unix(path);
  if (!listener) return failure(std::move(listener).error());
  auto wake_up = make_wake_up();
  if (!wake_up) return failure(std::move(wake_up).error());
  std::unique_ptr<ControlServer> server(
      new ControlServer(path, *std::move(listener), *std::move(wake_up), instrument, stage, usb));
  server->thread_ = std::jthread([s = server.get()](const std::stop_token& stop) { s->run(stop); });
  return server;
}

ControlServer::ControlServer(std::string path, FileDescriptor listener, FileDescriptor wake_up,
                             LiveInstrument& instrument, const StageWire& stage, UsbPorts* usb)
    : path_(std::move(path)),
      listener_(std::move(listener)),
      wake_up_(std::move(wake_up)),
      instrument_(instrument),
      stage_(stage),
      usb_(usb) {}

ControlServer::~ControlServer() {
  thread_.request_stop();
  wake(wake_up_);
  thread_.join();
  ::unlink(path_.c_str());
}

void ControlServer::run(const std::stop_token& stop) {
  std::vector<pollfd> watched;
  while (!stop.stop_requested()) {
    watched.assign({{wake_up_.get(), POLLIN, 0}, {listener_.get(), POLLIN, 0}});
    for (const Client& client : clients_) watched.push_back({client.socket.get(), POLLIN, 0});
    if (::poll(watched.data(), watched.size(), -1) < 0) continue;
    drain(wake_up_);
    std::size_t k = 2;
    for (Client& client : clients_) {
      if (watched[k++].revents != 0) receive(client);
    }
    clients_.remove_if([](const Client& client) { return client.is_gone; });
    if ((watched[1].revents & POLLIN) == 0) continue;
    FileDescriptor socket(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
    if (socket.get() < 0 || clients_.size() >= kMostClients) continue;
    setsockopt(socket.get(), SOL_SOCKET, SO_SNDTIMEO, &kSendPatience, sizeof kSendPatience);
    clients_.push_back({.socket = std::move(socket), .received = {}});
  }
}

void ControlServer::receive(Client& client) {
  std::array<char, 4096> bytes{};
  const ssize_t n = ::recv(client.socket.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (n <= 0) {
    client.is_gone = n == 0 || (errno != EAGAIN && errno != EINTR);
    return;
  }
  client.received.append(bytes.data(), static_cast<std::size_t>(n));
  for (std::size_t end = client.received.find('\n'); end != std::string::npos; end = client.received.find('\n')) {
    const std::string answer = answer_control(client.received.substr(0, end), instrument_, stage_) + "\n";
    if (usb_ != nullptr) usb_->look_at_faults();
    client.received.erase(0, end + 1);
    if (send_all(client.socket.get(), answer)) continue;
    client.is_gone = true;
    return;
  }
  if (client.received.size() > kLongestLine) client.is_gone = true;
}

}  // namespace gonio::sim
