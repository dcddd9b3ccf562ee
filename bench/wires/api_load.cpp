#include "bench/wires/api_load.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "sim/wires/file_descriptor.h"

namespace gonio::bench {
namespace {

using Steady = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kAskEvery{500};

sim::FileDescriptor client_of(int port, std::string_view path) {
  sim::FileDescriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) return socket;
  const std::string request = "GET /api/v1/" + std::string(path) +
                              " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) + "\r\nAccept: */*\r\n\r\n";
  (void)::send(socket.get(), request.data(), request.size(), MSG_NOSIGNAL);
  return socket;
}

void ask_again(const sim::FileDescriptor& socket, int port) {
  const std::string request =
      "GET /api/v1/status HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) + "\r\nAccept: */*\r\n\r\n";
  (void)::send(socket.get(), request.data(), request.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

}  // namespace

ApiLoad::ApiLoad(int port, int event_clients, int status_clients)
    : thread_([=, this](const std::stop_token& stop) { run(stop, port, event_clients, status_clients); }) {}

void ApiLoad::run(const std::stop_token& stop, int port, int event_clients, int status_clients) {
  std::vector<sim::FileDescriptor> sockets;
  std::vector<pollfd> watched;
  std::vector<Steady::time_point> asked;
  for (int k = 0; k < event_clients + status_clients; ++k) {
    sockets.push_back(client_of(port, k < event_clients ? "events" : "status"));
    watched.push_back({sockets.back().get(), POLLIN, 0});
    asked.push_back(Steady::now());
  }
  const auto is_reader = [event_clients](std::size_t k) { return k < static_cast<std::size_t>(event_clients); };
  std::array<char, 16384> bytes{};
  std::vector<bool> is_answered(sockets.size(), false);
  while (!stop.stop_requested()) {
    ::poll(watched.data(), watched.size(), 10);
    for (std::size_t k = 0; k < sockets.size(); ++k) {
      if (watched[k].revents != 0) {
        const ssize_t n = ::recv(watched[k].fd, bytes.data(), bytes.size(), MSG_DONTWAIT);
        if (n == 0) watched[k].fd = -1;  // dropped by the daemon: poll passes over it
        if (n > 0 && is_reader(k)) event_bytes_ += n;
        if (n > 0 && !is_reader(k)) is_answered[k] = true;
      }
      if (is_reader(k) || !is_answered[k] || Steady::now() - asked[k] < kAskEvery) continue;
      ++answers_;
      asked[k] = Steady::now();
      is_answered[k] = false;
      ask_again(sockets[k], port);
    }
  }
}

}  // namespace gonio::bench
