#include "daemon/http/listening_socket.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace gonio::daemon {
namespace {

constexpr int kBacklog = 128;

Error socket_error(ErrorCode code, const std::string& where, std::string seen, std::string limit = {}) {
  return {.code = code,
          .device = "http",
          .tried = "listen on " + where,
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

Error errno_error(const std::string& where) {
  const int error = errno;
  return socket_error(error == EADDRINUSE ? ErrorCode::PortBusy : ErrorCode::InvalidInput, where, std::strerror(error));
}

union Address {
  sockaddr any;
  sockaddr_in v4;
  sockaddr_in6 v6;
  sockaddr_un file;
};

struct LoopbackAddress {
  Address address{};
  socklen_t size = 0;
};

Result<LoopbackAddress> loopback_address(const std::string& text, std::uint16_t port) {
  const std::string numeric = text == "localhost" ? "127.0.0.1" : text;
  const std::string where = text + ":" + std::to_string(port);
  LoopbackAddress found;
  bool is_loopback = false;
  if (inet_pton(AF_INET, numeric.c_str(), &found.address.v4.sin_addr) == 1) {
    found.size = sizeof(sockaddr_in);
    found.address.v4.sin_family = AF_INET;
    found.address.v4.sin_port = htons(port);
    is_loopback = (ntohl(found.address.v4.sin_addr.s_addr) >> 24U) == IN_LOOPBACKNET;
  } else if (inet_pton(AF_INET6, numeric.c_str(), &found.address.v6.sin6_addr) == 1) {
    found.size = sizeof(sockaddr_in6);
    found.address.v6.sin6_family = AF_INET6;
    found.address.v6.sin6_port = htons(port);
    is_loopback = IN6_IS_ADDR_LOOPBACK(&found.address.v6.sin6_addr);
  } else {
    return failure(socket_error(ErrorCode::InvalidInput, where, "\"" + text + "\" is not an address",
                                "a numeric address, such as 127.0.0.1"));
  }
  if (is_loopback) return found;
  return failure(socket_error(ErrorCode::NotAuthorised, where, "the address can be reached from other machines",
                              "a loopback address: others would need logins and encryption"));
}

bool somebody_listens(const Address& address) {
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool answered = connect(probe, &address.any, sizeof address.file) == 0;
  close(probe);
  return answered;
}

}  // namespace

ListeningSocket::ListeningSocket(ListeningSocket&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)) {}

ListeningSocket::~ListeningSocket() {
  if (descriptor_ >= 0) close(descriptor_);
}

int ListeningSocket::give_away() {
  return std::exchange(descriptor_, -1);
}

Result<ListeningSocket> ListeningSocket::tcp(const std::string& address, std::uint16_t port) {
  const Result<LoopbackAddress> place = loopback_address(address, port);
  if (!place) return failure(place.error());
  const std::string where = address + ":" + std::to_string(port);
  ListeningSocket made(socket(place->address.any.sa_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int yes = 1;  // connections of a daemon that has just ended must not keep the port
  setsockopt(made.descriptor_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (bind(made.descriptor_, &place->address.any, place->size) != 0 || listen(made.descriptor_, kBacklog) != 0) {
    return failure(errno_error(where));
  }
  return made;
}

Result<ListeningSocket> ListeningSocket::unix_file(const std::string& path) {
  Address address{};
  address.file.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.file.sun_path) {
    return failure(socket_error(ErrorCode::InvalidInput, path, std::to_string(path.size()) + " characters",
                                std::to_string(sizeof address.file.sun_path - 1) + " characters"));
  }
  path.copy(address.file.sun_path, path.size());
  if (somebody_listens(address)) {
    return failure(socket_error(ErrorCode::PortBusy, path, "another program answers there"));
  }
  unlink(path.c_str());
  ListeningSocket made(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  constexpr mode_t kOwnerAndGroup = 0660;
  if (bind(made.descriptor_, &address.any, sizeof address.file) != 0 || chmod(path.c_str(), kOwnerAndGroup) != 0 ||
      listen(made.descriptor_, kBacklog) != 0) {
    return failure(errno_error(path));
  }
  return made;
}

std::uint16_t ListeningSocket::port() const {
  Address address{};
  socklen_t size = sizeof address;
  if (getsockname(descriptor_, &address.any, &size) != 0) return 0;
  return ntohs(address.any.sa_family == AF_INET6 ? address.v6.sin6_port : address.v4.sin_port);
}

Result<Listeners> Listeners::bind(const std::string& address, std::uint16_t port, const std::string& path) {
  Result<ListeningSocket> tcp = ListeningSocket::tcp(address, port);
  if (!tcp) return failure(tcp.error());
  Listeners bound{.tcp = std::move(*tcp), .file = std::nullopt, .file_path = path};
  if (path.empty()) return bound;
  Result<ListeningSocket> file = ListeningSocket::unix_file(path);
  if (!file) return failure(file.error());
  bound.file.emplace(std::move(*file));
  return bound;
}

std::string peer_name(int connection) {
  ucred peer{};
  socklen_t size = sizeof peer;
  Address address{};
  socklen_t address_size = sizeof address;
  if (getsockname(connection, &address.any, &address_size) != 0 || address.any.sa_family != AF_UNIX) return "local";
  if (getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return "local";
  return "uid:" + std::to_string(peer.uid);
}

}  // namespace gonio::daemon
