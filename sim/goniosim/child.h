#pragma once

#include <sys/types.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"

namespace gonio::sim {

/// The program that goniosim starts on its wires. Its own process group: a Ctrl-C at the terminal reaches it through
/// goniosim alone, once. Threads: owned by one.
class Child {
 public:
  /// `arguments[0]` is the program, looked for beside `executable` first, then in the PATH; {state} in an argument
  /// becomes `state_folder`. `more_environment` joins this process' own. Errors: FileUnreadable.
  [[nodiscard]] static Result<Child> start(std::vector<std::string> arguments, const std::string& executable,
                                           const std::string& state_folder,
                                           const std::map<std::string, std::string>& more_environment);
  void signal(int number) const;
  /// The exit code, 128 + N for an end by signal N, once it has ended.
  [[nodiscard]] std::optional<int> ended() const;

 private:
  explicit Child(pid_t pid) : pid_(pid) {}
  pid_t pid_;
};

}  // namespace gonio::sim
