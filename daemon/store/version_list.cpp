#include "daemon/store/version_list.h"

#include <charconv>

namespace gonio::daemon {

std::string version_list_text(const std::vector<CalibrationVersion>& versions) {
  std::string text;
  for (const CalibrationVersion version : versions) text += (text.empty() ? "" : " ") + std::to_string(version);
  return text;
}

std::vector<CalibrationVersion> version_list_from(std::string_view text) {
  std::vector<CalibrationVersion> versions;
  const char* at = text.data();
  const char* const end = at + text.size();
  CalibrationVersion version = 0;
  while (at < end) {
    const auto [rest, error] = std::from_chars(at, end, version);
    if (error != std::errc()) break;
    versions.push_back(version);
    at = rest < end ? rest + 1 : rest;
  }
  return versions;
}

}  // namespace gonio::daemon
