#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/result.h"

namespace gonio::daemon {

/// A bound, listening, non-blocking socket; closed at the end unless it was given away.
class ListeningSocket {
 public:
  /// `address`: an IPv4 or IPv6 address of loopback, or "localhost". Port 0: any free one.
  /// Errors: PortBusy, NotAuthorised (not loopback: that needs logins, which this daemon does not have), InvalidInput.
  [[nodiscard]] static Result<ListeningSocket> tcp(const std::string& address, std::uint16_t port);
  /// A file that nobody listens on any more is replaced. Mode 0660. Errors: PortBusy, InvalidInput (path too long, no
  /// folder).
  [[nodiscard]] static Result<ListeningSocket> unix_file(const std::string& path);

  ListeningSocket(ListeningSocket&& other) noexcept;
  ListeningSocket& operator=(ListeningSocket&&) = delete;
  ~ListeningSocket();

  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] std::uint16_t port() const;

  /// From now on someone else closes it.
  [[nodiscard]] int give_away();

 private:
  explicit ListeningSocket(int descriptor) : descriptor_(descriptor) {}
  int descriptor_ = -1;
};

/// Where a daemon answers: bound before anything else is begun, so that a busy port changes nothing.
struct Listeners {
  ListeningSocket tcp;
  std::optional<ListeningSocket> file;
  std::string file_path;  ///< removed when the server ends

  /// `path` empty: no unix socket. Errors: those of its parts.
  [[nodiscard]] static Result<Listeners> bind(const std::string& address, std::uint16_t port, const std::string& path);
};

/// "uid:1000": who is at the other end of a unix socket's connection; "local" for others.
[[nodiscard]] std::string peer_name(int connection);

}  // namespace gonio::daemon
