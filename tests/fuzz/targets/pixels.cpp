// Images of any pixel format and odd sizes, beside a reading bit by bit; and packed pixels of a tape.
#include <vector>

#include "drivers/links/pixel_unpacking.h"
#include "drivers/links/tape/packing.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

using drivers::PixelFormat;
using drivers::PixelPacking;

// One pixel, from the layouts' own words (GigE Vision 2.0, 25.2; PFNC 2.1).
unsigned pixel_at(const PixelFormat& format, Bytes bytes, std::size_t k) {
  const auto bits = static_cast<std::size_t>(format.significant_bits);
  const unsigned mask = (1U << bits) - 1U;
  if (format.packing == PixelPacking::LsbPacked) {
    unsigned value = 0;
    for (std::size_t bit = 0; bit < bits; ++bit) {
      const std::size_t at = k * bits + bit;
      value |= (static_cast<unsigned>(bytes[at / 8]) >> at % 8 & 1U) << bit;
    }
    return value;
  }
  if (format.packing == PixelPacking::GigePacked) {
    const std::size_t group = k / 2 * 3;
    const unsigned middle = bytes[group + 1];
    const unsigned lower = middle >> (k % 2 == 0 ? 0U : 4U) & ((1U << (bits - 8)) - 1U);
    return static_cast<unsigned>(bytes[group + (k % 2 == 0 ? 0 : 2)]) << (bits - 8) | lower;
  }
  if (bits <= 8) return bytes[k] & mask;
  return (bytes[2 * k] + 256U * bytes[2 * k + 1]) & mask;
}

void check_format(ByteSource& source) {
  const auto formats = drivers::pixel_formats();
  const PixelFormat& format = formats[source.byte() % formats.size()];
  const Bytes bytes = source.rest();
  std::size_t count = 0;
  while (drivers::packed_size(format, count + 1) <= bytes.size()) ++count;
  const auto values = drivers::unpack(format, bytes.first(drivers::packed_size(format, count)), count);
  hold(values.size() == count, "as many pixels as were asked for");
  for (std::size_t k = 0; k < count; ++k)
    hold(values[k] == pixel_at(format, bytes, k), "a pixel is the one of its layout");
}

void check_packing(ByteSource& source) {
  const std::size_t count = source.word();
  const Bytes bytes = source.rest();
  const auto unpacked = drivers::unpack_pixels(bytes, count);
  if (unpacked)
    hold(unpacked->size() == count, "as many pixels as were asked for");
  else
    hold_error(unpacked.error());
  std::vector<std::uint16_t> pixels(bytes.size() / 2);
  for (std::size_t k = 0; k < pixels.size(); ++k)
    pixels[k] = static_cast<std::uint16_t>(bytes[2 * k] * 256 + bytes[2 * k + 1]);
  const auto same = drivers::unpack_pixels(drivers::pack_pixels(pixels), pixels.size());
  hold(same && *same == pixels, "pixels that are packed come back");
}

}  // namespace

void pixels(Bytes input) {
  ByteSource source(input);
  if ((source.byte() & 1U) != 0) return check_packing(source);
  check_format(source);
}

}  // namespace gonio::fuzz
