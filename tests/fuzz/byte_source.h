#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace gonio::fuzz {

using Bytes = std::span<const std::uint8_t>;

/// An input, taken from its front: once it is used up, zeros come for ever.
class ByteSource {
 public:
  explicit ByteSource(Bytes bytes) : left_(bytes) {}

  [[nodiscard]] bool is_empty() const { return left_.empty(); }
  std::uint8_t byte() {
    if (left_.empty()) return 0;
    const std::uint8_t first = left_.front();
    left_ = left_.subspan(1);
    return first;
  }
  std::uint16_t word() {
    const auto high = static_cast<unsigned>(byte());
    return static_cast<std::uint16_t>(high << 8U | byte());
  }
  /// 0 to `last`.
  std::size_t up_to(std::size_t last) { return word() % (last + 1); }
  /// At most so many.
  Bytes some(std::size_t most) {
    const Bytes taken = left_.first(std::min(most, left_.size()));
    left_ = left_.subspan(taken.size());
    return taken;
  }
  /// A length byte, then so many bytes.
  Bytes counted() { return some(byte()); }
  Bytes rest() { return some(left_.size()); }

 private:
  Bytes left_;
};

[[nodiscard]] inline std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace gonio::fuzz
