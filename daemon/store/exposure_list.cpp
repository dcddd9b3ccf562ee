#include "daemon/store/exposure_list.h"

#include <charconv>
#include <cstdint>

namespace gonio::daemon {

std::string exposure_list_text(const std::vector<Duration>& exposures) {
  std::string text;
  for (const Duration exposure : exposures) {
    if (!text.empty()) text += ' ';
    text += std::to_string(exposure.count());
  }
  return text;
}

std::vector<Duration> exposure_list_from(std::string_view text) {
  std::vector<Duration> exposures;
  const char* at = text.data();
  const char* const end = at + text.size();
  std::int64_t nanoseconds = 0;
  while (at < end) {
    const auto [rest, error] = std::from_chars(at, end, nanoseconds);
    if (error != std::errc()) break;
    exposures.emplace_back(nanoseconds);
    at = rest < end ? rest + 1 : rest;
  }
  return exposures;
}

}  // namespace gonio::daemon
