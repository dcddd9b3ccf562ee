#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace gonio::sim {

/// One of the ways in which the simulated camera sends its pixels.
struct SentFormat {
  std::string_view name;   ///< GenICam PFNC 2.1
  std::uint32_t code = 0;  ///< its third byte: bits that a pixel takes on the wire
  int bits = 0;            ///< of a pixel's value
  enum class Layout : std::uint8_t { Bytes, Gige, Stream } layout = Layout::Bytes;
};

/// All of them: Mono8, Mono10, Mono12, Mono14, Mono16, the GigE-packed and the lsb-packed ones of 10 and 12 bits.
[[nodiscard]] std::span<const SentFormat> sent_formats();
/// nullptr: none of that name, or code.
[[nodiscard]] const SentFormat* sent_format(std::string_view name);
[[nodiscard]] const SentFormat* sent_format(std::uint32_t code);

/// The bytes of an image, in the order of the wire; the rest of an incomplete last group is 0.
[[nodiscard]] std::vector<std::uint8_t> packed_bytes(const SentFormat& format, std::span<const std::uint16_t> pixels);
[[nodiscard]] std::uint32_t payload_size(const SentFormat& format, std::uint32_t pixels);

}  // namespace gonio::sim
