#include "drivers/links/tape/packing.h"

#include <zlib.h>

#include <string>

namespace gonio::drivers {
namespace {

std::uint16_t folded(std::uint16_t difference) {
  const bool is_negative = (difference & 0x8000U) != 0;
  return static_cast<std::uint16_t>((static_cast<unsigned>(difference) << 1U) ^ (is_negative ? 0xFFFFU : 0U));
}

std::uint16_t unfolded(std::uint16_t value) {
  return static_cast<std::uint16_t>((value >> 1U) ^ ((value & 1U) != 0 ? 0xFFFFU : 0U));
}

}  // namespace

std::uint32_t crc32_of(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, bytes.data(), bytes.size()));
}

std::vector<std::uint8_t> pack_pixels(std::span<const std::uint16_t> pixels) {
  std::vector<std::uint8_t> planes(2 * pixels.size());
  std::uint16_t before = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const std::uint16_t value = folded(static_cast<std::uint16_t>(pixels[i] - before));
    planes[i] = static_cast<std::uint8_t>(value);
    planes[pixels.size() + i] = static_cast<std::uint8_t>(value >> 8U);
    before = pixels[i];
  }
  uLongf size = compressBound(planes.size());
  std::vector<std::uint8_t> packed(size);
  compress2(packed.data(), &size, planes.data(), planes.size(), Z_BEST_SPEED);
  packed.resize(size);
  return packed;
}

Result<std::vector<std::uint16_t>> unpack_pixels(std::span<const std::uint8_t> packed, std::size_t count) {
  std::vector<std::uint8_t> planes(2 * count);
  uLongf size = planes.size();
  const int outcome = uncompress(planes.data(), &size, packed.data(), packed.size());
  if (outcome != Z_OK || size != planes.size()) {
    return failure({.code = ErrorCode::IncompleteData,
                    .device = "tape",
                    .tried = "unpack the pixels of a frame",
                    .seen = outcome == Z_OK ? std::to_string(size / 2) + " pixels" : "they do not unpack",
                    .limit = std::to_string(count) + " pixels"});
  }
  std::vector<std::uint16_t> pixels(count);
  std::uint16_t before = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto value = static_cast<std::uint16_t>(planes[i] | planes[count + i] << 8U);
    before = static_cast<std::uint16_t>(before + unfolded(value));
    pixels[i] = before;
  }
  return pixels;
}

}  // namespace gonio::drivers
