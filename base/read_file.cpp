#include "base/read_file.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

namespace gonio {
namespace {

tl::unexpected<Error> unreadable_file(const std::string& path, int error_number) {
  return failure({.code = ErrorCode::FileUnreadable,
                  .tried = "read the file",
                  .seen = std::strerror(error_number),
                  .where = InputLocation{path, 0, ""}});
}

}  // namespace

// By C's streams: those of C++ throw from a folder, and tell nobody why a file cannot be read.
Result<std::string> read_file(const std::string& path) {
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, Closer> file(std::fopen(path.c_str(), "rbe"));
  if (!file) return unreadable_file(path, errno);
  std::string bytes;
  std::array<char, 65536> part;
  while (const std::size_t n = std::fread(part.data(), 1, part.size(), file.get())) bytes.append(part.data(), n);
  if (std::ferror(file.get()) != 0) return unreadable_file(path, errno);
  return bytes;
}

}  // namespace gonio
