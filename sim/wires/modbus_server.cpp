#include "sim/wires/modbus_server.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <optional>
#include <utility>

namespace gonio::sim {
namespace {

constexpr std::size_t kMostClients = 64;
constexpr std::size_t kMostUnread = 64 * 1024;  // of a client that asks and does not read
constexpr std::size_t kMbapHeader = 6;          // of the MBAP header, up to and with the length
constexpr std::size_t kShortest = 8;            // unit and function code
constexpr std::size_t kLongest = 260;

// The request's header with the length of an exception, unit, exception.
std::vector<std::uint8_t> exception_frame(std::span<const std::uint8_t> request, std::uint8_t code) {
  constexpr std::uint8_t kUnitAndException = 3;
  std::vector<std::uint8_t> frame(request.begin(), request.begin() + kMbapHeader + 1);
  frame[4] = 0;
  frame[5] = kUnitAndException;
  const auto pdu = exception_pdu(request.subspan(kMbapHeader + 1), code);
  frame.insert(frame.end(), pdu.begin(), pdu.end());
  return frame;
}

}  // namespace

Result<std::unique_ptr<ModbusServer>> ModbusServer::start(LiveInstrument& instrument, const std::string& address,
                                                          std::uint16_t port) {
  auto listener = listen_tcp(address, port);
  if (!listener) return failure(std::move(listener).error());
  auto wake_up = make_wake_up();
  if (!wake_up) return failure(std::move(wake_up).error());
  auto reply = ModbusReply::make();
  if (!reply) return failure(std::move(reply).error());
  std::unique_ptr<ModbusServer> server(
      new ModbusServer(instrument, *std::move(listener), *std::move(wake_up), *std::move(reply)));
  server->thread_ = std::jthread([s = server.get()](const std::stop_token& stop) { s->run(stop); });
  return server;
}

ModbusServer::ModbusServer(LiveInstrument& instrument, FileDescriptor listener, FileDescriptor wake_up,
                           ModbusReply reply)
    : instrument_(instrument), listener_(std::move(listener)), wake_up_(std::move(wake_up)), reply_(std::move(reply)) {}

ModbusServer::~ModbusServer() {
  thread_.request_stop();
  wake(wake_up_);
}

void ModbusServer::set_refusing(bool on) {
  is_refusing_ = on;
  wake(wake_up_);
}

void ModbusServer::run(const std::stop_token& stop) {
  std::vector<pollfd> watched;
  while (!stop.stop_requested()) {
    watched.assign({{wake_up_.get(), POLLIN, 0}, {listener_.get(), POLLIN, 0}});
    for (const Client& client : clients_) {
      const bool has_more = !client.to_send.empty();
      watched.push_back({client.socket.get(), static_cast<short>(has_more ? POLLIN | POLLOUT : POLLIN), 0});
    }
    if (::poll(watched.data(), watched.size(), patience_ms()) < 0) continue;
    drain(wake_up_);
    release_late(instrument_.clock().now());
    std::size_t k = 2;
    for (Client& client : clients_) {
      const short events = watched[k++].revents;
      if ((events & (POLLIN | POLLHUP | POLLERR)) != 0) receive(client);
      if (!client.is_gone && !client.to_send.empty()) send(client);
    }
    if (is_refusing_ || drops_clients_) drop_clients();
    clients_.remove_if([](const Client& client) { return client.is_gone; });
    if ((watched[1].revents & POLLIN) != 0) accept_clients();
  }
}

void ModbusServer::accept_clients() {
  for (;;) {
    FileDescriptor socket(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (socket.get() < 0) return;
    if (refuses() || clients_.size() >= kMostClients) continue;  // closed at once
    const int on = 1;
    setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    clients_.push_back({.socket = std::move(socket), .received = {}, .to_send = {}, .late = {}, .last_look = {}});
  }
}

void ModbusServer::receive(Client& client) {
  std::array<std::uint8_t, 2048> bytes{};
  const ssize_t n = ::recv(client.socket.get(), bytes.data(), bytes.size(), 0);
  if (n > 0) {
    client.received.insert(client.received.end(), bytes.begin(), bytes.begin() + n);
    take_requests(client);
  } else if (n == 0 || (errno != EAGAIN && errno != EINTR)) {
    client.is_gone = true;
  }
}

void ModbusServer::take_requests(Client& client) {
  std::size_t at = 0;
  while (client.received.size() - at >= kMbapHeader) {
    const auto rest = std::span(client.received).subspan(at);
    const std::size_t length = kMbapHeader + static_cast<std::size_t>(rest[4] << 8U | rest[5]);
    const bool is_modbus = rest[2] == 0 && rest[3] == 0;
    if (!is_modbus || length < kShortest || length > kLongest) {
      client.is_gone = true;  // out of step: there is no way back into it
      return;
    }
    if (rest.size() < length) break;
    at += length;
    if (!is_silent_) answer(client, rest.first(length));
  }
  client.received.erase(client.received.begin(), client.received.begin() + static_cast<std::ptrdiff_t>(at));
  if (client.to_send.size() > kMostUnread) client.is_gone = true;
}

void ModbusServer::answer(Client& client, std::span<const std::uint8_t> request) {
  const auto pdu = request.subspan(kMbapHeader + 1);
  std::vector<std::uint8_t> reply;
  const ExchangeFate fate = instrument_.with([&](LiveInstrument::Parts& parts) {
    ExchangeFate asked = fate_of_exchange(parts, pdu);
    if (asked.is_silent || asked.is_refused) return asked;
    reply = asked.is(FaultKind::ReplyException) ? exception_frame(request, asked.fault->code())
                                                : reply_.answer(request, parts.units, parts.now);
    return asked;
  });
  drops_clients_ |= fate.is_refused;
  if (reply.empty()) return;
  FaultyReply out{.bytes = reply};
  if (fate.fault) out = spoil_tcp(*fate.fault, reply, client.last_look);
  if (exchange_kind(pdu, instrument_.scene().stage.registers) == ExchangeKind::Look)
    client.last_look = std::move(reply);
  drops_clients_ |= out.resets;
  resets_clients_ |= out.resets;
  if (out.late > Duration::zero())
    client.late.push_back({instrument_.clock().now() + out.late, std::move(out.bytes)});
  else
    client.to_send.insert(client.to_send.end(), out.bytes.begin(), out.bytes.end());
}

void ModbusServer::release_late(Instant now) {
  for (Client& client : clients_) {
    while (!client.late.empty() && client.late.front().due <= now) {
      const auto& bytes = client.late.front().bytes;
      client.to_send.insert(client.to_send.end(), bytes.begin(), bytes.end());
      client.late.pop_front();
    }
  }
}

int ModbusServer::patience_ms() const {
  std::optional<Instant> due;
  for (const Client& client : clients_) {
    if (!client.late.empty()) due = std::min(due.value_or(Instant::max()), client.late.front().due);
  }
  if (!due) return -1;
  const Duration left = std::max(*due - instrument_.clock().now(), Duration::zero());
  return static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(left).count());
}

bool ModbusServer::refuses() {
  return is_refusing_ || instrument_.with([](LiveInstrument::Parts& parts) {
    return parts.instrument.faults().active(FaultKind::StageRefuse, parts.now) != nullptr;
  });
}

// A connection that is closed with unsent bytes dropped ends in a reset.
void ModbusServer::drop_clients() {
  const linger at_once{.l_onoff = 1, .l_linger = 0};
  for (const Client& client : clients_) {
    if (resets_clients_) setsockopt(client.socket.get(), SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  }
  clients_.clear();
  drops_clients_ = false;
  resets_clients_ = false;
}

void ModbusServer::send(Client& client) {
  const ssize_t n = ::send(client.socket.get(), client.to_send.data(), client.to_send.size(), MSG_NOSIGNAL);
  if (n > 0) {
    client.to_send.erase(client.to_send.begin(), client.to_send.begin() + n);
  } else if (n < 0 && errno != EAGAIN && errno != EINTR) {
    client.is_gone = true;
  }
}

}  // namespace gonio::sim
