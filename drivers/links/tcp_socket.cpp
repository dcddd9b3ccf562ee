#include "drivers/links/tcp_socket.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace gonio::drivers {
namespace {

Error connect_error(ErrorCode code, const std::string& peer, std::string seen, std::string limit = {}) {
  return {.code = code,
          .device = "stage",
          .tried = fmt::format("connect to {}", peer),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

// What a finished, non-blocking connect left behind.
int connect_outcome(int fd) {
  int outcome = 0;
  socklen_t size = sizeof outcome;
  return getsockopt(fd, SOL_SOCKET, SO_ERROR, &outcome, &size) == 0 ? outcome : errno;
}

}  // namespace

TcpSocket::TcpSocket(TcpSocket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

TcpSocket& TcpSocket::operator=(TcpSocket&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

TcpSocket::~TcpSocket() {
  if (fd_ >= 0) ::close(fd_);
}

Result<TcpSocket> TcpSocket::make(const std::string& peer) {
  TcpSocket made(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (made.fd_ < 0) return failure(connect_error(ErrorCode::Unreachable, peer, std::strerror(errno)));
  if (made.fd_ >= FD_SETSIZE) {
    return failure(connect_error(ErrorCode::Unreachable, peer, fmt::format("file descriptor {}", made.fd_),
                                 fmt::format("below {}: too many files are open", FD_SETSIZE)));
  }
  const int on = 1;
  setsockopt(made.fd_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return made;
}

Result<void> TcpSocket::connect(const std::string& address, std::uint16_t port, Duration timeout) {
  const std::string peer = fmt::format("{}:{}", address, port);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  if (inet_pton(AF_INET, address.c_str(), &to.sin_addr) != 1) {
    return failure(connect_error(ErrorCode::InvalidInput, peer, fmt::format("address \"{}\"", address),
                                 "four numbers such as 192.168.0.10"));
  }
  if (::connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) return {};
  if (errno != EINPROGRESS) return failure(connect_error(ErrorCode::Unreachable, peer, std::strerror(errno)));
  pollfd waiting{fd_, POLLOUT, 0};
  const auto wait = std::chrono::ceil<std::chrono::milliseconds>(timeout);
  const int ready = poll(&waiting, 1, static_cast<int>(wait.count()));
  if (ready < 0) return failure(connect_error(ErrorCode::Unreachable, peer, std::strerror(errno)));
  if (ready == 0) {
    return failure(connect_error(ErrorCode::TimedOut, peer, "no answer", fmt::format("{} ms", wait.count())));
  }
  const int outcome = connect_outcome(fd_);
  if (outcome != 0) return failure(connect_error(ErrorCode::Unreachable, peer, std::strerror(outcome)));
  return {};
}

}  // namespace gonio::drivers
