#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/daemon_client.h"
#include "cli/run.h"
#include "protocol/api/analysis.h"

namespace gonio::cli {

/// The number when the text is one, above 0.
[[nodiscard]] std::optional<std::int64_t> scan_number(const std::string& text);

/// What to compare with: a scan by its number, a file that is there, else a model. `with_bytes`: a file's bytes go
/// along, for the daemon opens no client's path. Errors: FileUnreadable.
[[nodiscard]] Result<api::AnalysisRequest> comparison_request(const std::string& other, bool with_bytes);

/// Queues a job of the worker program and waits for its end; progress on standard error where that is a terminal's
/// turn. Ctrl-C cancels the job. Errors: those of the client, the job's own, Stopped.
[[nodiscard]] Result<api::AnalysisReport> run_analysis(DaemonClient& client, const api::AnalysisRequest& request,
                                                       World& world);

/// Fetches a job's files and writes each aside, then renames. `output`: a file's name for a job of one file, "-" for
/// standard output; of several files the part before its last dot takes the place of the job's own; empty: their own
/// names, here. What was written, by name. Errors: those of the client; InvalidInput.
[[nodiscard]] Result<std::vector<std::string>> take_files(DaemonClient& client, const api::AnalysisReport& job,
                                                          const std::string& output, World& world);

/// Losses, notes and the names of what was written, on standard error; facts as a table on standard output.
void tell(const api::AnalysisReport& job, const std::vector<std::string>& written, World& world);

}  // namespace gonio::cli
