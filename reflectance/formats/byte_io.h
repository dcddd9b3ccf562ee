#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "base/result.h"

namespace gonio::formats {

namespace detail {
template <std::size_t kBytes>
struct UnsignedOf;
template <>
struct UnsignedOf<1> {
  using Type = std::uint8_t;
};
template <>
struct UnsignedOf<2> {
  using Type = std::uint16_t;
};
template <>
struct UnsignedOf<4> {
  using Type = std::uint32_t;
};
template <>
struct UnsignedOf<8> {
  using Type = std::uint64_t;
};
}  // namespace detail

template <class T>
concept PlainNumber = std::integral<T> || std::floating_point<T>;

/// Appends a number's bytes, the least first, whatever the machine's order.
template <PlainNumber T>
void put_little_endian(std::string& out, T value) {
  const auto bits = std::bit_cast<typename detail::UnsignedOf<sizeof(T)>::Type>(value);
  for (std::size_t n = 0; n < sizeof(T); ++n)
    out += static_cast<char>((static_cast<std::uint64_t>(bits) >> (8 * n)) & 0xFFU);
}

/// The number in these bytes, of which there must be sizeof(T) (asserted by the caller).
template <PlainNumber T>
[[nodiscard]] T little_endian(const char* bytes) {
  std::uint64_t bits = 0;
  for (std::size_t n = 0; n < sizeof(T); ++n)
    bits |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[n])) << (8 * n);
  return std::bit_cast<T>(static_cast<typename detail::UnsignedOf<sizeof(T)>::Type>(bits));
}

/// A binary file read from the front, little-endian, with what an error needs to say where. The bytes must outlive it.
class ByteReader {
 public:
  ByteReader(std::string_view bytes, std::string format, std::string file);

  [[nodiscard]] std::size_t at() const { return at_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] const std::string& file() const { return file_; }

  /// Errors: InvalidInput when the file ends before.
  [[nodiscard]] Result<std::string_view> take(std::size_t count, std::string_view field);
  template <PlainNumber T>
  [[nodiscard]] Result<T> number(std::string_view field) {
    const Result<std::string_view> bytes = take(sizeof(T), field);
    if (!bytes) return failure(bytes.error());
    return little_endian<T>(bytes->data());
  }
  /// Bytes anywhere in the file, without moving. Errors: InvalidInput when they are not all there.
  [[nodiscard]] Result<std::string_view> slice(std::uint64_t offset, std::uint64_t count, std::string_view field) const;

  /// InvalidInput with "byte N, field".
  [[nodiscard]] Error error(std::string_view field, std::string seen, std::string limit = {}) const;

 private:
  std::string_view bytes_;
  std::string format_;
  std::string file_;
  std::size_t at_ = 0;
};

}  // namespace gonio::formats
