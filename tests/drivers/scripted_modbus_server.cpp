#include "tests/drivers/scripted_modbus_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <sstream>
#include <utility>

namespace gonio::drivers::test {
namespace {

constexpr std::size_t kHeader = 6;  // transaction, protocol, length; the length counts what follows

// False when the peer has gone or the test is over.
bool wait_readable(int fd, int wake) {
  pollfd both[2] = {{fd, POLLIN, 0}, {wake, POLLIN, 0}};
  return poll(both, 2, -1) > 0 && (both[1].revents & POLLIN) == 0;
}

bool read_exactly(int fd, int wake, Bytes& into, std::size_t count) {
  const std::size_t from = into.size();
  into.resize(from + count);
  for (std::size_t have = 0; have < count;) {
    if (!wait_readable(fd, wake)) return false;
    const ssize_t got = recv(fd, into.data() + from + have, count - have, 0);
    if (got <= 0) return false;
    have += static_cast<std::size_t>(got);
  }
  return true;
}

}  // namespace

Bytes bytes(const std::string& hex) {
  Bytes all;
  std::istringstream in(hex);
  for (std::string two; in >> two;) all.push_back(static_cast<std::uint8_t>(std::stoul(two, nullptr, 16)));
  return all;
}

Bytes reply_to(const Bytes& request, const Bytes& pdu) {
  Bytes frame{request[0], request[1], 0, 0, 0, static_cast<std::uint8_t>(pdu.size() + 1), request[6]};
  frame.insert(frame.end(), pdu.begin(), pdu.end());
  return frame;
}

ScriptedModbusServer::ScriptedModbusServer(Script script) : script_(std::move(script)) {
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  wake_ = eventfd(0, EFD_CLOEXEC);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (bind(listener_, reinterpret_cast<sockaddr*>(&address), size) != 0 || listen(listener_, 8) != 0) return;
  getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this] { serve(); });
}

ScriptedModbusServer::~ScriptedModbusServer() {
  eventfd_write(wake_, 1);
  if (thread_.joinable()) thread_.join();
  close(listener_);
  close(wake_);
}

std::vector<Bytes> ScriptedModbusServer::requests() const {
  const std::lock_guard lock(mutex_);
  return requests_;
}

int ScriptedModbusServer::connections() const {
  const std::lock_guard lock(mutex_);
  return connections_;
}

void ScriptedModbusServer::wait_for_requests(std::size_t count) const {
  while (requests().size() < count) std::this_thread::yield();
}

void ScriptedModbusServer::serve() {
  while (wait_readable(listener_, wake_)) {
    const int client = accept(listener_, nullptr, nullptr);
    if (client < 0) return;
    {
      const std::lock_guard lock(mutex_);
      ++connections_;
    }
    converse(client);
    close(client);
  }
}

void ScriptedModbusServer::converse(int client) {
  for (;;) {
    Bytes request;
    if (!read_exactly(client, wake_, request, kHeader)) return;
    const std::size_t rest = static_cast<std::size_t>(request[4]) * 256U + request[5];
    if (!read_exactly(client, wake_, request, rest)) return;
    int connection = 0;
    {
      const std::lock_guard lock(mutex_);
      requests_.push_back(request);
      connection = connections_ - 1;
    }
    const Answer answer = script_(request, connection);
    if (!answer.reply.empty()) send(client, answer.reply.data(), answer.reply.size(), MSG_NOSIGNAL);
    if (answer.closes) return;
  }
}

}  // namespace gonio::drivers::test
