#pragma once

#include "base/result.h"

namespace gonio::daemon {

/// Sets the number of files that may be open (soft RLIMIT_NOFILE) to FD_SETSIZE, 1024: libmodbus waits with select,
/// which cannot hold more. Call first of all in main. Errors: Internal (the system refused; with its reason).
[[nodiscard]] Result<void> limit_open_files();

}  // namespace gonio::daemon
