#include "daemon/analysis/read_whole_file.h"

#include <cstdint>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

namespace gonio::analysis {

Result<std::string> read_whole_file(const std::string& path) {
  constexpr std::uintmax_t kMost = 2ULL << 30U;
  Error error{.code = ErrorCode::FileUnreadable,
              .tried = "open the file",
              .seen = "it does not exist or may not be read",
              .where = InputLocation{path, 0, ""}};
  std::error_code reason;
  const std::uintmax_t size = std::filesystem::file_size(path, reason);
  if (reason) return failure(std::move(error));
  if (size > kMost) {
    error.code = ErrorCode::TooLarge;
    error.seen = fmt::format("{} bytes", size);
    error.limit = fmt::format("at most {} bytes", kMost);
    return failure(std::move(error));
  }
  std::ifstream in(path, std::ios::binary);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(in.gcount()) != size) return failure(std::move(error));
  return bytes;
}

}  // namespace gonio::analysis
