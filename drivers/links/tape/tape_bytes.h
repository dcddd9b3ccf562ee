#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gonio::drivers {

/// Puts numbers and texts one after the other, low byte first.
class ByteWriter {
 public:
  ByteWriter& u8(std::uint8_t value) {
    bytes_.push_back(value);
    return *this;
  }
  ByteWriter& u16(std::uint16_t value) { return whole(value, 2); }
  ByteWriter& u32(std::uint32_t value) { return whole(value, 4); }
  ByteWriter& i64(std::int64_t value) { return whole(static_cast<std::uint64_t>(value), 8); }
  ByteWriter& f64(double value) { return whole(std::bit_cast<std::uint64_t>(value), 8); }
  /// Its length in 4 bytes, then itself.
  ByteWriter& text(std::string_view value) {
    return blob({reinterpret_cast<const std::uint8_t*>(value.data()), value.size()});
  }
  ByteWriter& blob(std::span<const std::uint8_t> value) {
    u32(static_cast<std::uint32_t>(value.size()));
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    return *this;
  }
  ByteWriter& words(std::span<const std::uint16_t> values) {
    for (const std::uint16_t value : values) u16(value);
    return *this;
  }
  [[nodiscard]] std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  ByteWriter& whole(std::uint64_t value, int count) {
    for (int i = 0; i < count; ++i) bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    return *this;
  }
  std::vector<std::uint8_t> bytes_;
};

/// Takes them out again. Beyond the end it gives zeros and empty texts, and `is_whole` turns false: asked once, at the
/// end.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : left_(bytes) {}

  std::uint8_t u8() { return static_cast<std::uint8_t>(whole(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(whole(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(whole(4)); }
  std::int64_t i64() { return static_cast<std::int64_t>(whole(8)); }
  double f64() { return std::bit_cast<double>(whole(8)); }
  std::span<const std::uint8_t> blob() { return raw(u32()); }
  std::string text() {
    const std::span<const std::uint8_t> bytes = blob();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  /// All that is left, as words.
  std::vector<std::uint16_t> words() {
    std::vector<std::uint16_t> values(left_.size() / 2);
    for (std::uint16_t& value : values) value = u16();
    return values;
  }
  /// Nothing was missing, and nothing is left.
  [[nodiscard]] bool is_done() const { return is_whole_ && left_.empty(); }
  [[nodiscard]] bool is_whole() const { return is_whole_; }

 private:
  std::span<const std::uint8_t> raw(std::size_t count) {
    if (count > left_.size()) {
      is_whole_ = false;
      left_ = {};
      return {};
    }
    const std::span<const std::uint8_t> taken = left_.first(count);
    left_ = left_.subspan(count);
    return taken;
  }
  std::uint64_t whole(std::size_t count) {
    std::uint64_t value = 0;
    const std::span<const std::uint8_t> bytes = raw(count);
    for (std::size_t i = 0; i < bytes.size(); ++i) value |= std::uint64_t{bytes[i]} << (8 * i);
    return value;
  }

  std::span<const std::uint8_t> left_;
  bool is_whole_ = true;
};

}  // namespace gonio::drivers
