#include "sim/wires/pixel_packing.h"

#include <algorithm>
#include <array>

namespace gonio::sim {
namespace {

using PixelLayout = SentFormat::Layout;
using PackedBytes = std::vector<std::uint8_t>;

constexpr std::array kSentFormats{
    SentFormat{"Mono8", 0x01080001, 8, PixelLayout::Bytes},
    SentFormat{"Mono10", 0x01100003, 10, PixelLayout::Bytes},
    SentFormat{"Mono12", 0x01100005, 12, PixelLayout::Bytes},
    SentFormat{"Mono14", 0x01100025, 14, PixelLayout::Bytes},
    SentFormat{"Mono16", 0x01100007, 16, PixelLayout::Bytes},
    SentFormat{"Mono10Packed", 0x010C0004, 10, PixelLayout::Gige},
    SentFormat{"Mono12Packed", 0x010C0006, 12, PixelLayout::Gige},
    SentFormat{"Mono10p", 0x010A0046, 10, PixelLayout::Stream},
    SentFormat{"Mono12p", 0x010C0047, 12, PixelLayout::Stream},
};

void push_byte(PackedBytes& bytes, unsigned value) {
  bytes.push_back(static_cast<std::uint8_t>(value & 0xFFU));
}

// Low byte first.
void pack_bytes(int bits, std::span<const std::uint16_t> pixels, PackedBytes& bytes) {
  for (const std::uint16_t pixel : pixels) {
    push_byte(bytes, pixel);
    if (bits > 8) push_byte(bytes, static_cast<unsigned>(pixel) >> 8U);
  }
}

// GigE Vision 2.0, section 25.2: upper bits, both lower parts in nibbles, upper bits.
void pack_gige(int bits, std::span<const std::uint16_t> pixels, PackedBytes& bytes) {
  const auto low = static_cast<unsigned>(bits) - 8U;
  for (std::size_t k = 0; k < pixels.size(); k += 2) {
    const unsigned a = pixels[k];
    const bool has_second = k + 1 < pixels.size();
    const unsigned b = has_second ? pixels[k + 1] : 0U;
    const unsigned mask = (1U << low) - 1U;
    push_byte(bytes, a >> low);
    push_byte(bytes, (a & mask) | (b & mask) << 4U);
    if (has_second) push_byte(bytes, b >> low);
  }
}

// PFNC 2.1, "p": a stream of bits, lowest first.
void pack_stream(int bits, std::span<const std::uint16_t> pixels, PackedBytes& bytes) {
  const auto width = static_cast<unsigned>(bits);
  bytes.assign((pixels.size() * width + 7) / 8, 0);
  std::size_t at = 0;
  for (const std::uint16_t pixel : pixels) {
    for (unsigned bit = 0; bit < width; ++bit, ++at) {
      const unsigned one = (static_cast<unsigned>(pixel) >> bit) & 1U;
      bytes[at / 8] = static_cast<std::uint8_t>(bytes[at / 8] | one << (at % 8));
    }
  }
}

}  // namespace

std::span<const SentFormat> sent_formats() {
  return kSentFormats;
}

const SentFormat* sent_format(std::string_view name) {
  const auto* found = std::ranges::find(kSentFormats, name, &SentFormat::name);
  return found == kSentFormats.end() ? nullptr : found;
}

const SentFormat* sent_format(std::uint32_t code) {
  const auto* found = std::ranges::find(kSentFormats, code, &SentFormat::code);
  return found == kSentFormats.end() ? nullptr : found;
}

std::vector<std::uint8_t> packed_bytes(const SentFormat& format, std::span<const std::uint16_t> pixels) {
  PackedBytes bytes;
  bytes.reserve(payload_size(format, static_cast<std::uint32_t>(pixels.size())));
  switch (format.layout) {
    case PixelLayout::Bytes:
      pack_bytes(format.bits, pixels, bytes);
      break;
    case PixelLayout::Gige:
      pack_gige(format.bits, pixels, bytes);
      break;
    case PixelLayout::Stream:
      pack_stream(format.bits, pixels, bytes);
      break;
  }
  return bytes;
}

std::uint32_t payload_size(const SentFormat& format, std::uint32_t pixels) {
  const std::uint64_t on_the_wire = (format.code >> 16U) & 0xFFU;
  return static_cast<std::uint32_t>((pixels * on_the_wire + 7) / 8);
}

}  // namespace gonio::sim
