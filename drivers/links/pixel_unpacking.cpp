#include "drivers/links/pixel_unpacking.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace gonio::drivers {
namespace {

// Codes: GenICam PFNC 2.1, values of the 32-bit identifiers (monochrome, bits a pixel, number).
constexpr std::array kFormats{
    PixelFormat{"Mono8", 0x01080001, 8, PixelPacking::None},
    PixelFormat{"Mono10", 0x01100003, 10, PixelPacking::None},
    PixelFormat{"Mono12", 0x01100005, 12, PixelPacking::None},
    PixelFormat{"Mono14", 0x01100025, 14, PixelPacking::None},
    PixelFormat{"Mono16", 0x01100007, 16, PixelPacking::None},
    PixelFormat{"Mono10Packed", 0x010C0004, 10, PixelPacking::GigePacked},
    PixelFormat{"Mono12Packed", 0x010C0006, 12, PixelPacking::GigePacked},
    PixelFormat{"Mono10p", 0x010A0046, 10, PixelPacking::LsbPacked},
    PixelFormat{"Mono12p", 0x010C0047, 12, PixelPacking::LsbPacked},
};

constexpr unsigned kByteBits = 8;

std::size_t bytes_per_pixel(const PixelFormat& format) {
  return format.significant_bits > 8 ? 2 : 1;
}

std::uint16_t mask_of(const PixelFormat& format) {
  return static_cast<std::uint16_t>((1U << static_cast<unsigned>(format.significant_bits)) - 1U);
}

void unpack_whole_bytes(const PixelFormat& format, std::span<const std::uint8_t> bytes,
                        std::span<std::uint16_t> pixels) {
  if (bytes_per_pixel(format) == 1) {
    std::copy_n(bytes.begin(), pixels.size(), pixels.begin());
    return;
  }
  const unsigned mask = mask_of(format);
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    const unsigned value = bytes[2 * k] | static_cast<unsigned>(bytes[2 * k + 1]) << kByteBits;
    pixels[k] = static_cast<std::uint16_t>(value & mask);
  }
}

// The lower bits of both pixels share the middle byte: the first's from bit 0, the second's from bit 4.
void unpack_gige(const PixelFormat& format, std::span<const std::uint8_t> bytes, std::span<std::uint16_t> pixels) {
  const auto low_bits = static_cast<unsigned>(format.significant_bits) - kByteBits;
  const unsigned low_mask = (1U << low_bits) - 1U;
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    const std::size_t group = k / 2 * 3;
    const bool is_second = k % 2 == 1;
    const unsigned high = bytes[group + (is_second ? 2 : 0)];
    const unsigned low = static_cast<unsigned>(bytes[group + 1]) >> (is_second ? 4U : 0U);
    pixels[k] = static_cast<std::uint16_t>(high << low_bits | (low & low_mask));
  }
}

void unpack_lsb(const PixelFormat& format, std::span<const std::uint8_t> bytes, std::span<std::uint16_t> pixels) {
  const auto bits = static_cast<unsigned>(format.significant_bits);
  const unsigned mask = mask_of(format);
  unsigned held = 0;  // bits read and not handed out, the oldest lowest
  unsigned n_held = 0;
  std::size_t next = 0;
  for (std::uint16_t& pixel : pixels) {
    for (; n_held < bits; n_held += kByteBits) held |= static_cast<unsigned>(bytes[next++]) << n_held;
    pixel = static_cast<std::uint16_t>(held & mask);
    held >>= bits;
    n_held -= bits;
  }
}

template <class Matches>
std::optional<PixelFormat> find(Matches matches) {
  const auto* found = std::find_if(kFormats.begin(), kFormats.end(), matches);
  if (found == kFormats.end()) return std::nullopt;
  return *found;
}

}  // namespace

std::span<const PixelFormat> pixel_formats() {
  return kFormats;
}

std::string pixel_format_names() {
  std::string names;
  for (const PixelFormat& format : kFormats) {
    if (!names.empty()) names += ", ";
    names += format.name;
  }
  return names;
}

std::optional<PixelFormat> pixel_format_of_name(std::string_view name) {
  return find([&](const PixelFormat& format) { return format.name == name; });
}

std::optional<PixelFormat> pixel_format_of_code(std::uint32_t code) {
  return find([&](const PixelFormat& format) { return format.code == code; });
}

std::size_t packed_size(const PixelFormat& format, std::size_t pixels) {
  switch (format.packing) {
    case PixelPacking::None:
      return bytes_per_pixel(format) * pixels;
    case PixelPacking::GigePacked:
      return pixels / 2 * 3 + pixels % 2 * 2;
    case PixelPacking::LsbPacked:
      return (pixels * static_cast<std::size_t>(format.significant_bits) + kByteBits - 1) / kByteBits;
  }
  return 0;
}

std::vector<std::uint16_t> unpack(const PixelFormat& format, std::span<const std::uint8_t> bytes, std::size_t pixels) {
  assert(bytes.size() >= packed_size(format, pixels));
  std::vector<std::uint16_t> values(pixels);
  switch (format.packing) {
    case PixelPacking::None:
      unpack_whole_bytes(format, bytes, values);
      break;
    case PixelPacking::GigePacked:
      unpack_gige(format, bytes, values);
      break;
    case PixelPacking::LsbPacked:
      unpack_lsb(format, bytes, values);
      break;
  }
  return values;
}

}  // namespace gonio::drivers
