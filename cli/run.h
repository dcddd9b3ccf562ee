#pragma once

#include <atomic>
#include <iosfwd>
#include <string>
#include <vector>

namespace gonio::cli {

/// What gonioctl meets of the world, so that tests can bring their own.
struct World {
  std::ostream& out;
  std::ostream& err;
  bool out_is_terminal = false;          ///< progress may rewrite its line
  const std::atomic<bool>& interrupted;  ///< Ctrl-C
  std::string default_connect;
};

inline constexpr int kInterruptedExit = 130;

/// Does what the arguments (after the program's name) say. Returns the exit code: 0, or the one of the error's code, 2
/// for a wrong line, 130 when interrupted.
[[nodiscard]] int run(const std::vector<std::string>& arguments, World& world);

}  // namespace gonio::cli
