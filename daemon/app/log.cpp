#include "daemon/app/log.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

namespace gonio::daemon {

void start_log(const std::string& level) {
  auto logger = std::make_shared<spdlog::logger>("goniod", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  logger->set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %-7l %v", spdlog::pattern_time_type::utc);
  logger->set_level(spdlog::level::from_str(level));
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

// The sentence is an argument, never a pattern: it may hold braces.
void log_debug(const std::string& sentence) {
  spdlog::debug("{}", sentence);
}
bool log_shows_debug() {
  return spdlog::should_log(spdlog::level::debug);
}
void log_info(const std::string& sentence) {
  spdlog::info("{}", sentence);
}
void log_warning(const std::string& sentence) {
  spdlog::warn("{}", sentence);
}
void log_error(const std::string& sentence) {
  spdlog::error("{}", sentence);
}

}  // namespace gonio::daemon
