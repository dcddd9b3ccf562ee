#include "sim/wires/sockets.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cerrno>
#include <cstring>

namespace gonio::sim {
namespace {

constexpr int kBacklog = 64;

Error socket_error(std::string tried) {
  const int why = errno;
  const bool is_busy = why == EADDRINUSE;
  return {
      .code = is_busy ? ErrorCode::PortBusy : (why == EADDRNOTAVAIL ? ErrorCode::InvalidInput : ErrorCode::Internal),
      .device = "goniosim",
      .tried = std::move(tried),
      .seen = is_busy ? "another program has it" : std::strerror(why)};
}

Result<sockaddr_in> inet_address(const std::string& address, std::uint16_t port) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  if (inet_pton(AF_INET, address.c_str(), &to.sin_addr) == 1) return to;
  return failure({.code = ErrorCode::InvalidInput,
                  .device = "goniosim",
                  .tried = "bind a socket",
                  .seen = fmt::format("address \"{}\"", address),
                  .limit = "four numbers such as 127.0.0.1"});
}

Result<FileDescriptor> bound(int type, const std::string& address, std::uint16_t port) {
  const auto to = inet_address(address, port);
  if (!to) return failure(to.error());
  const std::string tried = fmt::format("bind {}:{}", address, port);
  FileDescriptor made(::socket(AF_INET, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (made.get() < 0) return failure(socket_error(tried));
  const int on = 1;
  if (type == SOCK_STREAM) setsockopt(made.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const auto* any = reinterpret_cast<const sockaddr*>(&*to);
  if (::bind(made.get(), any, sizeof *to) != 0) return failure(socket_error(tried));
  return made;
}

// Whether a program still answers behind this socket file.
bool is_alive(const sockaddr_un& address) {
  const FileDescriptor probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  return ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

}  // namespace

Result<FileDescriptor> listen_tcp(const std::string& address, std::uint16_t port) {
  auto made = bound(SOCK_STREAM, address, port);
  if (!made) return made;
  if (::listen(made->get(), kBacklog) != 0) return failure(socket_error(fmt::format("listen on {}:{}", address, port)));
  return made;
}

Result<FileDescriptor> bind_udp(const std::string& address, std::uint16_t port) {
  return bound(SOCK_DGRAM, address, port);
}

Result<FileDescriptor> hear_broadcasts(std::uint16_t port) {
  const auto to = inet_address("255.255.255.255", port);
  if (!to) return failure(to.error());
  FileDescriptor made(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int on = 1;
  setsockopt(made.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (::bind(made.get(), reinterpret_cast<const sockaddr*>(&*to), sizeof *to) != 0)
    return failure(socket_error(fmt::format("hear broadcasts to port {}", port)));
  return made;
}

Result<FileDescriptor> listen_unix(const std::string& path) {
  const std::string tried = fmt::format("listen on {}", path);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    return failure({.code = ErrorCode::InvalidInput,
                    .device = "goniosim",
                    .tried = tried,
                    .seen = fmt::format("a path of {} characters", path.size()),
                    .limit = fmt::format("at most {}", sizeof address.sun_path - 1)});
  }
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  if (!is_alive(address)) ::unlink(path.c_str());
  FileDescriptor made(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (::bind(made.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(made.get(), kBacklog) != 0) {
    return failure(socket_error(tried));
  }
  return made;
}

std::uint16_t port_of(const FileDescriptor& socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

Result<FileDescriptor> make_wake_up() {
  FileDescriptor made(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (made.get() < 0) return failure(socket_error("make an event descriptor"));
  return made;
}

void wake(const FileDescriptor& wake_up) {
  const std::uint64_t one = 1;
  // Full means that it is readable already.
  [[maybe_unused]] const ssize_t n = ::write(wake_up.get(), &one, sizeof one);
}

void drain(const FileDescriptor& wake_up) {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t n = ::read(wake_up.get(), &count, sizeof count);
}

}  // namespace gonio::sim
