#pragma once

#include <string>
#include <vector>

#include "base/result.h"

namespace gonio::cli {

struct ReplayLine {
  std::string tape;
  std::string store;       ///< empty: the tape's name with ".sqlite"
  std::string against;     ///< empty: none
  std::string instrument;  ///< empty: the tape's own
};

/// The goniod command that replays; the program is the one beside this one.
[[nodiscard]] std::vector<std::string> replay_command(const ReplayLine& wanted, const std::string& own_path);

/// Becomes it: output and exit code are goniod's. Returns only when that failed. Errors: FileUnreadable.
[[nodiscard]] Error become_replay(const ReplayLine& wanted);

}  // namespace gonio::cli
