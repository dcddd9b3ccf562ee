#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gonio::drivers {

/// How the bits of neighbouring pixels lie in the bytes of an image. Byte k is the k-th on the wire.
enum class PixelPacking : std::uint8_t {
  /// One pixel a byte, or one in two, the low byte first (GenICam PFNC 2.1, "unpacked").
  None,
  /// "Packed" of GigE Vision (GigE Vision 2.0, section 25.2): two pixels in three bytes. The first and third hold their
  /// upper
  /// eight bits, the one between the lower bits of the first pixel (from bit 0) and of the second (from bit 4).
  GigePacked,
  /// "p" of PFNC 2.1 (USB3 Vision and newer GigE cameras): a stream of bits, the lowest bit of the first pixel in the
  /// lowest bit of the first byte, nothing between two pixels.
  LsbPacked,
};

/// A monochrome pixel format that the drivers take.
struct PixelFormat {
  std::string_view name;   ///< by PFNC: "Mono12p"
  std::uint32_t code = 0;  ///< by PFNC: 0x010C0047
  int significant_bits = 0;
  PixelPacking packing = PixelPacking::None;
};

/// Mono8, Mono10, Mono12, Mono14, Mono16, Mono10Packed, Mono12Packed, Mono10p, Mono12p; in this order.
[[nodiscard]] std::span<const PixelFormat> pixel_formats();
/// Their names, for an error's limit.
[[nodiscard]] std::string pixel_format_names();
[[nodiscard]] std::optional<PixelFormat> pixel_format_of_name(std::string_view name);
[[nodiscard]] std::optional<PixelFormat> pixel_format_of_code(std::uint32_t code);

/// How many bytes so many pixels take, an incomplete last group rounded up. Lines are not padded.
[[nodiscard]] std::size_t packed_size(const PixelFormat& format, std::size_t pixels);
/// The first `pixels` values of an image; bits above the significant ones are cleared. `bytes` must hold
/// packed_size(format, pixels) at least. Pure.
[[nodiscard]] std::vector<std::uint16_t> unpack(const PixelFormat& format, std::span<const std::uint8_t> bytes,
                                                std::size_t pixels);

}  // namespace gonio::drivers
