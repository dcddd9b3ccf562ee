#pragma once

#include <cstdint>
#include <string>

#include "base/clock.h"
#include "base/result.h"

namespace gonio::drivers {

/// A connected TCP socket, or none. It is made here and not by libmodbus for two reasons: libmodbus would pass a
/// descriptor of FD_SETSIZE or above to select, which ends the process, and it cannot be interrupted while connecting.
/// Threads: owned by one, but for `TcpModbusLink`'s use of the descriptor for shutdown.
class TcpSocket {
 public:
  TcpSocket() = default;
  TcpSocket(TcpSocket&& other) noexcept;
  TcpSocket& operator=(TcpSocket&& other) noexcept;
  TcpSocket(const TcpSocket&) = delete;
  TcpSocket& operator=(const TcpSocket&) = delete;
  ~TcpSocket();

  /// Makes the descriptor; `connect` follows. `address` is an IPv4 address in digits: no name is ever looked up.
  /// Errors: Unreachable (also a descriptor of FD_SETSIZE or above: too many files are open).
  [[nodiscard]] static Result<TcpSocket> make(const std::string& peer);
  /// Errors: Unreachable (refused, no route), TimedOut (nothing heard for `timeout`), InvalidInput (not an address).
  [[nodiscard]] Result<void> connect(const std::string& address, std::uint16_t port, Duration timeout);

  [[nodiscard]] int descriptor() const { return fd_; }

 private:
  explicit TcpSocket(int fd) : fd_(fd) {}
  int fd_ = -1;
};

}  // namespace gonio::drivers
