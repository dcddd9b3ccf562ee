#include "reflectance/formats/byte_io.h"

#include <utility>

#include <fmt/format.h>

namespace gonio::formats {

ByteReader::ByteReader(std::string_view bytes, std::string format, std::string file)
    : bytes_(bytes), format_(std::move(format)), file_(std::move(file)) {}

Result<std::string_view> ByteReader::take(std::size_t count, std::string_view field) {
  if (left() < count)
    return failure(
        error(field, fmt::format("the file ends at byte {}", bytes_.size()), fmt::format("{} bytes", count)));
  at_ += count;
  return bytes_.substr(at_ - count, count);
}

Result<std::string_view> ByteReader::slice(std::uint64_t offset, std::uint64_t count, std::string_view field) const {
  if (offset <= bytes_.size() && count <= bytes_.size() - offset) return bytes_.substr(offset, count);
  return failure(error(field, fmt::format("{} bytes from byte {} on", count, offset),
                       fmt::format("the file has {} bytes", bytes_.size())));
}

Error ByteReader::error(std::string_view field, std::string seen, std::string limit) const {
  return {.code = ErrorCode::InvalidInput,
          .tried = "read it as " + format_,
          .seen = std::move(seen),
          .limit = std::move(limit),
          .where = InputLocation{file_, 0, fmt::format("byte {}, {}", at_, field)}};
}

}  // namespace gonio::formats
