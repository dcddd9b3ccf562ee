#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"
#include "sim/wires/file_descriptor.h"

namespace gonio::sim {

/// A listening TCP socket, not blocking; port 0 takes any free one. Errors: PortBusy, Internal.
[[nodiscard]] Result<FileDescriptor> listen_tcp(const std::string& address, std::uint16_t port);
/// A bound UDP socket, not blocking. Errors: PortBusy, InvalidInput (not an IPv4 address of this machine).
[[nodiscard]] Result<FileDescriptor> bind_udp(const std::string& address, std::uint16_t port);
/// Datagrams that were sent to all; any number of sockets may hear them. Errors: PortBusy, Internal.
[[nodiscard]] Result<FileDescriptor> hear_broadcasts(std::uint16_t port);
/// A listening unix socket; a file left behind by a dead program is replaced. Errors: PortBusy, Internal.
[[nodiscard]] Result<FileDescriptor> listen_unix(const std::string& path);
[[nodiscard]] std::uint16_t port_of(const FileDescriptor& socket);

/// A descriptor that another thread can make readable, to end a poll. Errors: Internal.
[[nodiscard]] Result<FileDescriptor> make_wake_up();
void wake(const FileDescriptor& wake_up);
void drain(const FileDescriptor& wake_up);

}  // namespace gonio::sim
