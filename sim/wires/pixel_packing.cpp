#include "sim/wires/pixel_packing.h"

#include <algorithm>
#include <array>

namespace gonio::sim {
namespace {

using Layout = SentFormat::Layout;
using Bytes = std::vector<std::uint8_t>;

constexpr std::array kFormats{
    SentFormat{"Mono8", 0x01080001, 8, Layout::Bytes},        SentFormat{"Mono10", 0x01100003, 10, Layout::Bytes},
    SentFormat{"Mono12", 0x01100005, 12, Layout::Bytes},      SentFormat{"Mono14", 0x01100025, 14, Layout::Bytes},
    SentFormat{"Mono16", 0x01100007, 16, Layout::Bytes},      SentFormat{"Mono10Packed", 0x010C0004, 10, Layout::Gige},
    SentFormat{"Mono12Packed", 0x010C0006, 12, Layout::Gige}, SentFormat{"Mono10p", 0x010A0046, 10, Layout::Stream},
    SentFormat{"Mono12p", 0x010C0047, 12, Layout::Stream},
};

void put(Bytes& bytes, unsigned value) {
  bytes.push_back(static_cast<std::uint8_t>(value & 0xFFU));
}

// Low byte first.
void pack_bytes(int bits, std::span<const std::uint16_t> pixels, Bytes& bytes) {
  for (const std::uint16_t pixel : pixels) {
    put(bytes, pixel);
    if (bits > 8) put(bytes, static_cast<unsigned>(pixel) >> 8U);
  }
}

// GigE Vision 2.0, section 25.2: upper bits, both lower parts in nibbles, upper bits.
void pack_gige(int bits, std::span<const std::uint16_t> pixels, Bytes& bytes) {
  const auto low = static_cast<unsigned>(bits) - 8U;
  for (std::size_t k = 0; k < pixels.size(); k += 2) {
    const unsigned a = pixels[k];
    const bool has_second = k + 1 < pixels.size();
    const unsigned b = has_second ? pixels[k + 1] : 0U;
    const unsigned mask = (1U << low) - 1U;
    put(bytes, a >> low);
    put(bytes, (a & mask) | (b & mask) << 4U);
    if (has_second) put(bytes, b >> low);
  }
}

// PFNC 2.1, "p": a stream of bits, lowest first.
void pack_stream(int bits, std::span<const std::uint16_t> pixels, Bytes& bytes) {
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
  return kFormats;
}

const SentFormat* sent_format(std::string_view name) {
  const auto* found = std::ranges::find(kFormats, name, &SentFormat::name);
  return found == kFormats.end() ? nullptr : found;
}

const SentFormat* sent_format(std::uint32_t code) {
  const auto* found = std::ranges::find(kFormats, code, &SentFormat::code);
  return found == kFormats.end() ? nullptr : found;
}

std::vector<std::uint8_t> packed_bytes(const SentFormat& format, std::span<const std::uint16_t> pixels) {
  Bytes bytes;
  bytes.reserve(payload_size(format, static_cast<std::uint32_t>(pixels.size())));
  switch (format.layout) {
    case Layout::Bytes:
      pack_bytes(format.bits, pixels, bytes);
      break;
    case Layout::Gige:
      pack_gige(format.bits, pixels, bytes);
      break;
    case Layout::Stream:
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
