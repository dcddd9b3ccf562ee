#pragma once

#include <string>

namespace gonio::daemon {

/// What an operator reads at 3 a.m.: one sentence a line, with device, value and unit. Threads: any.
/// `level`: "debug", "info", "warning" or "error". To standard error.
void start_log(const std::string& level);
void log_debug(const std::string& sentence);
/// Whether anybody would see it: a sentence takes longer to make than a reading to store.
[[nodiscard]] bool log_shows_debug();
void log_info(const std::string& sentence);
void log_warning(const std::string& sentence);
void log_error(const std::string& sentence);

}  // namespace gonio::daemon
