#pragma once

#include <string>
#include <vector>

#include "base/result.h"

namespace gonio::daemon {

/// The command that runs goniosim with this daemon as its child: `goniosim SCENE [--seed N] [--state DIR] -- goniod
/// --instrument {state}/instrument.toml ...`. goniosim replaces {state}. The daemon's own arguments stay as they are,
/// but for --simulate and --instrument. `own_path` is this program's; goniosim lies beside it.
[[nodiscard]] std::vector<std::string> simulation_command(const std::vector<std::string>& arguments,
                                                          const std::string& own_path);

/// Becomes that command. Returns only when it cannot. Errors: FileUnreadable.
[[nodiscard]] Error become(const std::vector<std::string>& command);

/// The path of the running program.
[[nodiscard]] std::string own_path();

}  // namespace gonio::daemon
