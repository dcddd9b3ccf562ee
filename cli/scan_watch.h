#pragma once

#include <cstdint>

#include "cli/daemon_client.h"
#include "cli/run.h"

namespace gonio::cli {

/// Shows progress until the scan is over: one line rewritten on a terminal, a line for each change elsewhere. Returns
/// how it ended. Errors: those of the client; Stopped when interrupted (the scan goes on).
[[nodiscard]] Result<api::ScanReport> watch_scan(DaemonClient& client, std::int64_t scan, World& world);

/// Whether a state is an end: "done", "finished-early", "aborted", "failed".
[[nodiscard]] bool is_over(const api::ScanReport& scan);

}  // namespace gonio::cli
