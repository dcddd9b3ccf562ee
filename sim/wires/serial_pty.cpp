#include "sim/wires/serial_pty.h"

#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace gonio::sim {
namespace {

Error pty_error(ErrorCode code, std::string tried) {
  return {.code = code, .device = "goniosim", .tried = std::move(tried), .seen = std::strerror(errno), .limit = {}};
}

}  // namespace

Result<SerialPty> SerialPty::open(const std::string& link) {
  const std::string tried = "make a pseudo terminal";
  FileDescriptor master(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  std::array<char, 128> name{};
  if (master.get() < 0 || ::grantpt(master.get()) != 0 || ::unlockpt(master.get()) != 0 ||
      ::ptsname_r(master.get(), name.data(), name.size()) != 0) {
    return failure(pty_error(ErrorCode::Internal, tried));
  }
  FileDescriptor slave(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  if (slave.get() < 0 || ::tcgetattr(slave.get(), &settings) != 0)
    return failure(pty_error(ErrorCode::Internal, tried));
  ::cfmakeraw(&settings);
  if (::tcsetattr(slave.get(), TCSANOW, &settings) != 0) return failure(pty_error(ErrorCode::Internal, tried));
  const std::string aside = link + ".new";
  ::unlink(aside.c_str());
  if (::symlink(name.data(), aside.c_str()) != 0 || ::rename(aside.c_str(), link.c_str()) != 0) {
    return failure(pty_error(ErrorCode::InvalidInput, "make the link " + link));
  }
  return SerialPty(std::move(master), std::move(slave));
}

}  // namespace gonio::sim
