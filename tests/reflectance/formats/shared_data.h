#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

namespace gonio::formats {

/// Data and schemas of others, which are not part of the project: in $GONIO_SHARED, else beside the source tree.
/// GONIO_SOURCE_DIR is what CMake says: __FILE__ may be relative. A test that finds none says so and checks nothing.
inline std::filesystem::path shared_folder() {
  if (const char* named = std::getenv("GONIO_SHARED")) return named;
  return std::filesystem::path(GONIO_SOURCE_DIR) / "../shared";
}

inline std::optional<std::string> file_content(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(in), {});
}

}  // namespace gonio::formats
